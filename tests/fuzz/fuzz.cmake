# The fuzz targets (tests/fuzz/run.sh builds and runs them), by clang with -D DYNWITNESS_FUZZ=ON: the
# preset "check". Of the project they need scene/ and the reader of states.
if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
  message(FATAL_ERROR "DYNWITNESS_FUZZ: the compiler is ${CMAKE_CXX_COMPILER_ID}, allowed: clang (the preset \"check\")")
endif()
add_custom_target(fuzzers)
function(dynwitness_fuzzer NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK;DEFINE" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/tests/)
  add_executable(fuzz_${NAME} EXCLUDE_FROM_ALL ${ARG_SOURCES} ${PROJECT_SOURCE_DIR}/tests/fixtures/mutations.cpp)
  target_compile_definitions(fuzz_${NAME} PRIVATE DYNWITNESS_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ${ARG_DEFINE})
  target_link_libraries(fuzz_${NAME} PRIVATE ${ARG_LINK})
  target_link_options(fuzz_${NAME} PRIVATE -fsanitize=fuzzer)
  add_dependencies(fuzzers fuzz_${NAME})
endfunction()
set(number 0)
foreach(format toml urdf mjcf)
  dynwitness_fuzzer(${format} SOURCES fuzz/fuzz_scene.cpp fixtures/near_files.cpp LINK dynwitness::scene
                    DEFINE FUZZ_FORMAT=${number})
  math(EXPR number "${number} + 1")
endforeach()
dynwitness_fuzzer(states SOURCES fuzz/fuzz_states.cpp LINK dynwitness::inputs)

if(DYNWITNESS_TESTS)
  add_dependencies(ground_floor_tests fuzzers)
  # a quarter of a minute for each of four readers
  add_test(NAME readers_under_a_fuzzer
           COMMAND ${PROJECT_SOURCE_DIR}/tests/fuzz/run.sh ${PROJECT_BINARY_DIR} 15)
  set_tests_properties(readers_under_a_fuzzer PROPERTIES SKIP_RETURN_CODE 77 LABELS ground_floor COST 100)
endif()
