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

/// The rank in MPI_COMM_WORLD of one of the other group. MUSIC's data go from group to group, and
/// only there do both sides ring: others may use functions that do not.
int translated(MPI_Comm comm, int rank, const void* caller) {
  int has_other_group = 0;
  OF_MPI(MPI_Comm_test_inter, caller)(comm, &has_other_group);
  if (has_other_group == 0) {
    return kNobody;
  }
  // MPI_COMM_WORLD, whose symbol would link this library to MPI, has this number in Open MPI's
  // mpif.h.
  auto* const world = OF_MPI(MPI_Comm_f2c, caller)(0);
  MPI_Group all = nullptr;
  MPI_Group theirs = nullptr;
  int result = kNobody;
  OF_MPI(MPI_Comm_group, caller)(world, &all);
  OF_MPI(MPI_Comm_remote_group, caller)(comm, &theirs);
  OF_MPI(MPI_Group_translate_ranks, caller)(theirs, 1, &rank, all, &result);
  OF_MPI(MPI_Group_free, caller)(&theirs);
  OF_MPI(MPI_Group_free, caller)(&all);
  return result;
}

/// Remembers those that MUSIC uses again and again. When a new communicator gets the place of one
/// that was freed, a wrong bell rings, and receivers find their messages by looking.
int world_rank(MPI_Comm comm, int rank, const void* caller) {
  struct Known {
    MPI_Comm comm = nullptr;
    int rank = kNobody;
    int result = kNobody;
  };
  static thread_local std::array<Known, 64> known;
  if (rank == MPI_ANY_SOURCE) {
    rank = 0;  // a program that sends by MUSIC has one rank
  }
  if (!exists() || rank < 0) {  // MPI_PROC_NULL
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
  ring_partner();  // for the last piece
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
  MPI_Status own{};
  MPI_Status* const arrived = status == MPI_STATUS_IGNORE ? &own : status;
  begin(world_rank(comm, rank, CALLER));
  const int result = receive(data, count, type, rank, tag, comm, arrived);
  begin(world_rank(comm, arrived->MPI_SOURCE, CALLER));
  ring_partner();
  end();
  return result;
}

}  // extern "C"
