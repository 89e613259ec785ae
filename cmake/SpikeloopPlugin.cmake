# For authors of plug-ins: find_package(Spikeloop) brings these functions (docs/plugins.md).

# spikeloop_add_plugin(NAME source...)
# makes NAME.so, a shared library whose node classes Spikeloop's programs load.
function(spikeloop_add_plugin name)
  if(NOT ARGN)
    message(FATAL_ERROR "spikeloop_add_plugin(${name}): there is no source; write "
                        "spikeloop_add_plugin(${name} ${name}.cpp)")
  endif()
  add_library(${name} MODULE ${ARGN})
  spikeloop_compile_plugin(${name})
  # What the plug-in takes from Spikeloop's libraries stays its own: the program that loads it has the
  # same names.
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX ".so")
endfunction()

# spikeloop_link_plugins(PROGRAM source...)
# links the same sources into a program of one's own, whose Registry::add_linked_plugins() finds their
# node classes. They become objects, not a library: a linker leaves out what nobody calls by name.
function(spikeloop_link_plugins program)
  if(NOT ARGN)
    message(FATAL_ERROR "spikeloop_link_plugins(${program}): there is no source; write "
                        "spikeloop_link_plugins(${program} my_plugin.cpp)")
  endif()
  set(objects ${program}_linked_plugins)
  add_library(${objects} OBJECT ${ARGN})
  spikeloop_compile_plugin(${objects})
  target_compile_definitions(${objects} PRIVATE SPIKELOOP_STATIC_PLUGIN)
  # A file registers its plug-in by a name that is the same in all of them.
  set_target_properties(${objects} PROPERTIES UNITY_BUILD OFF)
  target_sources(${program} PRIVATE $<TARGET_OBJECTS:${objects}>)
  target_link_libraries(${program} PRIVATE Spikeloop::core)
endfunction()

# How every source of a plug-in is compiled. Optimised unless one has said otherwise: a node runs at
# every tick.
function(spikeloop_compile_plugin target)
  target_link_libraries(${target} PRIVATE Spikeloop::core)
  target_compile_features(${target} PRIVATE cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    target_compile_options(${target} PRIVATE -O2)
  endif()
endfunction()
