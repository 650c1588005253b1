# What the report needs beyond its sources: its style sheets inside the program, and the footer's facts
# (DYNWITNESS_COMMIT and DYNWITNESS_FLAGS are the caller's). Included once, after the target
# dynwitness_crosscheck is there.
set(report_dir ${CMAKE_CURRENT_LIST_DIR})
file(READ ${report_dir}/style.css DYNWITNESS_STYLE_CSS)
file(READ ${report_dir}/style.gp DYNWITNESS_STYLE_GNUPLOT)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${report_dir}/style.css ${report_dir}/style.gp)
configure_file(${report_dir}/assets.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp @ONLY)
target_sources(dynwitness_crosscheck PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp)

# on one file alone, so that a new commit recompiles no more than that
string(REGEX REPLACE " +" " " report_flags "${DYNWITNESS_FLAGS} -std=c++17")
string(STRIP "${report_flags}" report_flags)
set_property(SOURCE ${report_dir}/environment.cpp APPEND PROPERTY COMPILE_DEFINITIONS
  "DYNWITNESS_COMMIT=\"${DYNWITNESS_COMMIT}\""
  "DYNWITNESS_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\""
  "DYNWITNESS_FLAGS=\"${report_flags}\"")
