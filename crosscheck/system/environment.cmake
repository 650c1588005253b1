# The facts of the footer that the compiler cannot know (DYNWITNESS_COMMIT and DYNWITNESS_FLAGS are the
# caller's); on one file alone, so that a new commit recompiles no more than that
string(REGEX REPLACE " +" " " environment_flags "${DYNWITNESS_FLAGS} -std=c++17")
string(STRIP "${environment_flags}" environment_flags)
set_property(SOURCE crosscheck/system/environment.cpp APPEND PROPERTY COMPILE_DEFINITIONS
  "DYNWITNESS_COMMIT=\"${DYNWITNESS_COMMIT}\""
  "DYNWITNESS_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\""
  "DYNWITNESS_FLAGS=\"${environment_flags}\"")
