# Everything comes from Debian's packages: scripts/install-dependencies lists them.
find_package(Threads REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(muparser REQUIRED CONFIG)
find_package(PkgConfig REQUIRED)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(CycloneDDS REQUIRED)
if(SPIKELOOP_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(SPIKELOOP_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()

# Random123 is a set of headers without a CMake file; of Highway the headers alone are used.
find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
find_path(HIGHWAY_INCLUDE_DIR hwy/highway.h REQUIRED)

# Nodes in Python: the distribution's, for its NumPy, not another python3 that is first in PATH.
if(EXISTS /usr/bin/python3 AND NOT Python3_EXECUTABLE)
  set(Python3_EXECUTABLE /usr/bin/python3)
endif()
find_package(Python3 REQUIRED COMPONENTS Interpreter Development.Embed)
find_path(PYBIND11_INCLUDE_DIR pybind11/pybind11.h REQUIRED)

# MUSIC 1.1 needs MPI's C++ bindings; its headers are kept out of our warnings.
set(MPI_CXX_SKIP_MPICXX OFF)
find_package(MPI REQUIRED COMPONENTS CXX)
find_library(MUSIC_LIBRARY music REQUIRED)
find_path(MUSIC_INCLUDE_DIR music.hh REQUIRED)
add_library(spikeloop_mpi_music INTERFACE IMPORTED)
target_include_directories(spikeloop_mpi_music SYSTEM INTERFACE
                           ${MUSIC_INCLUDE_DIR} ${MPI_CXX_INCLUDE_DIRS})
target_link_libraries(spikeloop_mpi_music INTERFACE ${MUSIC_LIBRARY} ${MPI_CXX_LIBRARIES})

find_path(MUJOCO_INCLUDE_DIR mujoco/mujoco.h REQUIRED)
find_library(MUJOCO_LIBRARY mujoco REQUIRED)
add_library(spikeloop_mujoco_api INTERFACE IMPORTED)
target_include_directories(spikeloop_mujoco_api SYSTEM INTERFACE ${MUJOCO_INCLUDE_DIR})
target_link_libraries(spikeloop_mujoco_api INTERFACE ${MUJOCO_LIBRARY})

# Pictures. EGL and GLFW are opened when a program draws; their headers alone are needed here.
pkg_check_modules(PNG REQUIRED IMPORTED_TARGET GLOBAL libpng)
pkg_check_modules(MD REQUIRED IMPORTED_TARGET GLOBAL libmd)
find_path(EGL_INCLUDE_DIR EGL/egl.h REQUIRED)
find_path(GLFW_INCLUDE_DIR GLFW/glfw3.h REQUIRED)
