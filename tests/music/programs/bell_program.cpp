// An MPI program of three ranks: 0 and 2 send to 1 after computing for a while, by the functions
// that MUSIC uses, also to another group. Rank 1 prints what came, and how often it slept for it.
#include <mpi.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

constexpr int kMessages = 40;
constexpr int kLarge = 300'000;  // Open MPI sends such a message in pieces, with answers in between

void compute_for_5_ms() {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(5);
  while (std::chrono::steady_clock::now() < end) {
  }
}

long sleeps() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

}  // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  // Rank 1 alone, and the others, as programs of a MUSIC job: ranks of a group are not those of
  // all.
  MPI_Comm mine = MPI_COMM_NULL;
  MPI_Comm other = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, rank == 1 ? 1 : 0, rank, &mine);
  MPI_Intercomm_create(mine, 0, MPI_COMM_WORLD, rank == 1 ? 0 : 1, 7, &other);
  std::vector<double> large(kLarge, rank);
  int error = 0;
  if (rank == 1) {
    double sum = 0;
    long slept = 0;
    for (int i = 0; i < kMessages; ++i) {
      double value = 0;
      MPI_Status status{};
      const long before = sleeps();
      MPI_Recv(&value, 1, MPI_DOUBLE, MPI_ANY_SOURCE, 1, other, &status);
      slept += sleeps() - before;
      sum += value;
    }
    for (int from : {0, 1}) {
      MPI_Recv(large.data(), kLarge, MPI_DOUBLE, from, 2, other, MPI_STATUS_IGNORE);
      sum += large.front() + large.back();
    }
    std::printf("%g %ld\n", sum, slept / kMessages);
  } else {
    for (int i = 0; i < kMessages / 2; ++i) {
      compute_for_5_ms();
      const double value = i + 1000 * rank;
      if (i % 2 == 0) {
        error = MPI_Ssend(&value, 1, MPI_DOUBLE, 0, 1, other);
      } else {
        MPI_Request request = MPI_REQUEST_NULL;
        MPI_Isend(&value, 1, MPI_DOUBLE, 0, 1, other, &request);
        error = MPI_Waitall(1, &request, MPI_STATUSES_IGNORE);
      }
    }
    MPI_Ssend(large.data(), kLarge, MPI_DOUBLE, 0, 2, other);
  }
  MPI_Finalize();
  return error == MPI_SUCCESS ? 0 : 1;
}
