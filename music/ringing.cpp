// The functions of MPI that ring a bell. MUSIC sends by MPI_Ssend, which waits for the receiver's
// answer, and by MPI_Isend, and receives by MPI_Recv. What else programs wait for (collective
// functions, mostly before the first tick) they find by looking.
//
// It enters programs of any kind: MPI's own functions are those of the caller.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "bell.hpp"
#include "next_function.hpp"

namespace spikeloop::bell {
namespace {

/// MPI's function of that name, of the type of ours.
template <class Function>
Function* mpi(Function* /*like*/, const char* name, const void* caller) {
  void* const found = next_function(name, caller);
  if (found == nullptr) {
    fprintf(stderr, "MPI's function %s is not found\n", name);
    abort();
  }
  return reinterpret_cast<Function*>(found);
}

// Ours are found before MPI's under the name without the P.
#define OF_MPI(NAME, CALLER) mpi(static_cast<decltype(&NAME)>(nullptr), "P" #NAME, CALLER)

/// The rank in MPI_COMM_WORLD of one of a communicator: in the other group, if it has two.
int translated(MPI_Comm comm, int rank, const void* caller) {
  // Its symbol may be copied into the program, where a library does not find it. 0 is its number in
  // Open MPI's mpif.h.
  auto* const world = OF_MPI(MPI_Comm_f2c, caller)(0);
  int has_two = 0;
  MPI_Group all = nullptr;
  MPI_Group theirs = nullptr;
  int result = kNobody;
  OF_MPI(MPI_Comm_test_inter, caller)(comm, &has_two);
  OF_MPI(MPI_Comm_group, caller)(world, &all);
  if (has_two != 0) {
    OF_MPI(MPI_Comm_remote_group, caller)(comm, &theirs);
  } else {
    OF_MPI(MPI_Comm_group, caller)(comm, &theirs);
  }
  OF_MPI(MPI_Group_translate_ranks, caller)(theirs, 1, &rank, all, &result);
  OF_MPI(MPI_Group_free, caller)(&theirs);
  OF_MPI(MPI_Group_free, caller)(&all);
  return result;
}

/// Remembers those that MUSIC uses again and again. When a new communicator gets the place of one
/// that was freed, a wrong bell rings, and the receiver finds its message by looking.
int world_rank(MPI_Comm comm, int rank, const void* caller) {
  struct Known {
    MPI_Comm comm = nullptr;
    int rank = kNobody;
    int result = kNobody;
  };
  static thread_local std::array<Known, 64> known;
  if (!exists() || rank < 0) {  // MPI_ANY_SOURCE, MPI_PROC_NULL
    return kNobody;
  }
  const auto place = reinterpret_cast<std::uintptr_t>(comm) / 64 + static_cast<std::size_t>(rank);
  Known& entry = known[place % known.size()];
  if (entry.comm != comm || entry.rank != rank) {
    entry = {comm, rank, translated(comm, rank, caller)};
  }
  return entry.result;
}

}  // namespace
}  // namespace spikeloop::bell

using namespace spikeloop::bell;

#define CALLER __builtin_return_address(0)

extern "C" {

int MPI_Ssend(const void* data, int count, MPI_Datatype type, int rank, int tag, MPI_Comm comm) {
  static auto* const send = OF_MPI(MPI_Ssend, CALLER);
  begin(world_rank(comm, rank, CALLER));
  const int result = send(data, count, type, rank, tag, comm);
  end();
  return result;
}

int MPI_Isend(const void* data, int count, MPI_Datatype type, int rank, int tag, MPI_Comm comm,
              MPI_Request* request) {
  static auto* const send = OF_MPI(MPI_Isend, CALLER);
  const int result = send(data, count, type, rank, tag, comm, request);
  begin(world_rank(comm, rank, CALLER));
  ring_partner();
  end();
  return result;
}

int MPI_Recv(void* data, int count, MPI_Datatype type, int rank, int tag, MPI_Comm comm,
             MPI_Status* status) {
  static auto* const receive = OF_MPI(MPI_Recv, CALLER);
  begin(world_rank(comm, rank, CALLER));
  const int result = receive(data, count, type, rank, tag, comm, status);
  begin(world_rank(comm, status == MPI_STATUS_IGNORE ? rank : status->MPI_SOURCE, CALLER));
  ring_partner();
  end();
  return result;
}

}  // extern "C"
