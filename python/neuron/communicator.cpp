// NEURON's ParallelContext takes all processes of mpirun for its own: it duplicates MPI_COMM_WORLD,
// and waits for ever for programs that are none of NEURON's. Opened before NEURON, this library
// stands in front of MPI's (MPI 3.1, section 14.2: the profiling interface) and gives it the
// processes of its section.
#include <mpi.h>

namespace {

MPI_Comm section = MPI_COMM_NULL;

}  // namespace

extern "C" {

__attribute__((visibility("default"))) void spikeloop_stand_in_for_world(int fortran_handle) {
  section = MPI_Comm_f2c(fortran_handle);
}

__attribute__((visibility("default"))) int MPI_Comm_dup(MPI_Comm communicator, MPI_Comm* copy) {
  const bool stand_in = communicator == MPI_COMM_WORLD && section != MPI_COMM_NULL;
  return PMPI_Comm_dup(stand_in ? section : communicator, copy);
}

}  // extern "C"
