# Headers by others that most files include, parsed once instead of in every file, which takes 2 to
# 5 s each. None of ours is among them: a change of ours recompiles what includes it and no more.
# Nor are CLI11 and json, for what they make of every file that sees them: CLI11's validators are objects
# that compile 94 kB of it (2.5 s and 0.15 GB a file), json instantiates 60 MB of its own (0.9 s), and only
# the command line and what writes files need them.
# -D CMAKE_DISABLE_PRECOMPILE_HEADERS=ON builds without; the linter does, and sees includes that are missing.
file(WRITE ${PROJECT_BINARY_DIR}/nothing.cpp.in "")
configure_file(${PROJECT_BINARY_DIR}/nothing.cpp.in ${PROJECT_BINARY_DIR}/nothing.cpp COPYONLY)

# The collector of g++ walks through all of a precompiled header each time; with 512 MB to fill, most
# files are done before its first turn.
if(PROJECT_IS_TOP_LEVEL)
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>)
endif()

# Code that can be moved: of static libraries that shared objects are linked from as well as programs,
# for which the linker takes the detours out. g++ would not inline what another library might define
# anew, which nothing does to ours.
function(dynwitness_make_movable TARGET)
  set_target_properties(${TARGET} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
endfunction()

# dynwitness_precompile(NAME [COOL] [MOVABLE] LINK TARGET... HEADERS HEADER...): a library of one empty
# file, whose headers dynwitness_use_precompiled(NAME TARGET...) gives to others. Macros that headers look
# at must be the same in both (g++ warns where they are not, and parses anew), and so must whether code can
# be moved, and the level of optimization: g++ takes that of the precompiled header, whatever a file says.
# COOL is -O1.
function(dynwitness_precompile NAME)
  cmake_parse_arguments(ARG "COOL;MOVABLE" "" "LINK;HEADERS" ${ARGN})
  # where the list changes, g++ would read the old precompiled header for the new one
  set(list ${PROJECT_BINARY_DIR}/dynwitness_${NAME}.headers)
  set(before)
  if(EXISTS ${list})
    file(READ ${list} before)
  endif()
  if(NOT before STREQUAL "${ARG_HEADERS}")
    file(REMOVE ${PROJECT_BINARY_DIR}/CMakeFiles/dynwitness_${NAME}.dir/cmake_pch.hxx.gch)
    file(WRITE ${list} "${ARG_HEADERS}")
  endif()
  add_library(dynwitness_${NAME} OBJECT ${PROJECT_BINARY_DIR}/nothing.cpp)
  target_link_libraries(dynwitness_${NAME} PRIVATE ${ARG_LINK})
  target_compile_features(dynwitness_${NAME} PRIVATE cxx_std_17)
  if(ARG_COOL)
    target_compile_options(dynwitness_${NAME} PRIVATE -O1)
  endif()
  if(ARG_MOVABLE)
    dynwitness_make_movable(dynwitness_${NAME})
  endif()
  target_precompile_headers(dynwitness_${NAME} PRIVATE ${ARG_HEADERS})
endfunction()
function(dynwitness_use_precompiled NAME)
  foreach(target ${ARGN})
    target_precompile_headers(${target} REUSE_FROM dynwitness_${NAME})
  endforeach()
endfunction()

set(standard <algorithm> <array> <cmath> <cstdint> <functional> <iostream> <limits> <map> <memory>
             <optional> <random> <set> <sstream> <stdexcept> <string> <tuple> <type_traits>
             <unordered_map> <utility> <variant> <vector>)
set(mathematics <Eigen/Cholesky> <Eigen/Core> <Eigen/Geometry> <Eigen/LU>
                <boost/math/constants/constants.hpp> <boost/multiprecision/cpp_int.hpp>)
set(libraries Boost::headers Eigen3::Eigen fmt::fmt)
set(headers ${standard} ${mathematics} <fmt/format.h>)
dynwitness_precompile(outside LINK ${libraries} HEADERS ${headers})
dynwitness_precompile(outside_cool COOL LINK ${libraries} HEADERS ${headers})
dynwitness_precompile(outside_movable MOVABLE LINK ${libraries} HEADERS ${headers})
dynwitness_precompile(outside_cool_movable COOL MOVABLE LINK ${libraries} HEADERS ${headers})
if(DYNWITNESS_TESTS)
  find_package(Boost 1.74 REQUIRED COMPONENTS unit_test_framework)
  dynwitness_precompile(outside_of_tests COOL LINK ${libraries} Boost::unit_test_framework
                        HEADERS ${standard} ${mathematics} <boost/test/data/monomorphic.hpp>
                                <boost/test/data/test_case.hpp> <boost/test/unit_test.hpp>)
endif()
