# The fast sweeps as the project's compiler makes them, and as a second one does (clang++ beside g++, or
# g++ beside clang++), where there is one: shared objects with the flags of a release, whatever this
# build's are. Benchmarks and counts of instructions use them through dynwitness_fast_by_compiler.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  find_program(DYNWITNESS_SECOND_COMPILER NAMES clang++-14 clang++)
else()
  find_program(DYNWITNESS_SECOND_COMPILER NAMES g++-12 g++)
endif()
mark_as_advanced(DYNWITNESS_SECOND_COMPILER)
set(fast_source ${PROJECT_SOURCE_DIR}/tests/benchmarks/fast_by_compiler.cpp)
file(GLOB fast_headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/recursive/*.hpp
     ${PROJECT_SOURCE_DIR}/recursive/fast/*)
get_target_property(eigen_folders Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(fast_includes -I${PROJECT_SOURCE_DIR})
foreach(folder ${eigen_folders} ${Boost_INCLUDE_DIRS})
  if(NOT folder STREQUAL "/usr/include")  # named, it would come before the library's own
    list(APPEND fast_includes -isystem ${folder})
  endif()
endforeach()

add_library(dynwitness_fast_by_compiler INTERFACE)
function(dynwitness_fast_by PREFIX COMPILER)
  set(object ${PROJECT_BINARY_DIR}/lib${PREFIX}_fast.so)
  add_custom_command(OUTPUT ${object}
    COMMAND ${COMPILER} -std=c++17 -O3 -DNDEBUG -fPIC -shared -fvisibility=hidden -DCOMPILER=${PREFIX}
            ${fast_includes} -o ${object} ${fast_source}
    DEPENDS ${fast_source} ${PROJECT_SOURCE_DIR}/tests/benchmarks/fast_by_compiler.hpp ${fast_headers}
    COMMENT "Building the fast sweeps with ${COMPILER}" VERBATIM)
  add_custom_target(dynwitness_fast_${PREFIX} DEPENDS ${object})
  add_dependencies(dynwitness_fast_by_compiler dynwitness_fast_${PREFIX})
  target_link_libraries(dynwitness_fast_by_compiler INTERFACE ${object})
endfunction()
dynwitness_fast_by(own ${CMAKE_CXX_COMPILER})
if(DYNWITNESS_SECOND_COMPILER)
  dynwitness_fast_by(second ${DYNWITNESS_SECOND_COMPILER})
  target_compile_definitions(dynwitness_fast_by_compiler INTERFACE DYNWITNESS_SECOND_COMPILER)
endif()
