# How every target of the project is made: one directory is one library is one target.
include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# The precompiled headers of the tests need these settings (manual of ccache, "Precompiled headers").
# Paths are relative, so that clones of the project share what is compiled.
find_program(SPIKELOOP_CCACHE ccache)
if(SPIKELOOP_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${SPIKELOOP_CCACHE})
  add_compile_options($<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-fpch-preprocess>)
endif()

# Results must not depend on how a compiler fuses a product and a sum (docs/architecture.md,
# "Bit-identical"), so contraction is off everywhere.
add_library(spikeloop_flags INTERFACE)
add_library(Spikeloop::flags ALIAS spikeloop_flags)
set_target_properties(spikeloop_flags PROPERTIES EXPORT_NAME flags)
target_compile_options(spikeloop_flags INTERFACE -ffp-contract=off)
target_compile_features(spikeloop_flags INTERFACE cxx_std_20)
install(TARGETS spikeloop_flags EXPORT SpikeloopTargets)

add_library(spikeloop_warnings INTERFACE)
target_compile_options(spikeloop_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>
  # Files compiled together look to it like headers, and their anonymous namespaces like a mistake.
  $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>
  $<$<BOOL:${SPIKELOOP_WERROR}>:-Werror>)

if(SPIKELOOP_SANITIZE)
  add_compile_options(-fsanitize=${SPIKELOOP_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all -g1)
  add_link_options(-fsanitize=${SPIKELOOP_SANITIZE})
endif()

# Code that reads files and arguments, and waits: a quarter less to compile, and nobody measures it.
set(SPIKELOOP_COLD_OPTIONS $<$<CONFIG:Release>:-O1>)

# spikeloop_library(NAME SOURCES file... [USES target...] [PRIVATE_USES target...] [INSTALLED] [COLD])
# makes Spikeloop::NAME with its public headers in include/spikeloop/NAME/. INSTALLED libraries are
# what find_package(Spikeloop) gives to authors of plug-ins.
function(spikeloop_library name)
  cmake_parse_arguments(ARG "INSTALLED;COLD" "" "SOURCES;USES;PRIVATE_USES" ${ARGN})
  set(target spikeloop_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(Spikeloop::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(${target} PUBLIC Spikeloop::flags ${ARG_USES}
                        PRIVATE $<BUILD_INTERFACE:spikeloop_warnings> ${ARG_PRIVATE_USES})
  if(ARG_COLD)
    target_compile_options(${target} PRIVATE ${SPIKELOOP_COLD_OPTIONS})
  endif()
  if(ARG_INSTALLED)
    install(TARGETS ${target} EXPORT SpikeloopTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  endif()
endfunction()

# spikeloop_program(NAME SOURCES file... USES target... [ALIASES other-name...] [COLD])
# makes an installed program; an alias is a symbolic link: the program looks at the name it was
# called by.
function(spikeloop_program name)
  cmake_parse_arguments(ARG "COLD" "" "SOURCES;USES;ALIASES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  if(ARG_COLD)
    target_compile_options(${name} PRIVATE ${SPIKELOOP_COLD_OPTIONS})
  endif()
  target_link_libraries(${name} PRIVATE spikeloop_warnings Spikeloop::flags ${ARG_USES})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  foreach(alias IN LISTS ARG_ALIASES)
    add_custom_command(TARGET ${name} POST_BUILD
      COMMAND ${CMAKE_COMMAND} -E create_symlink ${name} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${alias})
    install(FILES ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${alias} DESTINATION ${CMAKE_INSTALL_BINDIR})
  endforeach()
endfunction()
