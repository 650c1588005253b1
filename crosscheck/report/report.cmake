# What the report needs beyond its sources: its style sheets inside the program. Included once, after
# the target dynwitness_report is there.
set(report_dir ${CMAKE_CURRENT_LIST_DIR})
file(READ ${report_dir}/style.css DYNWITNESS_STYLE_CSS)
file(READ ${report_dir}/style.gp DYNWITNESS_STYLE_GNUPLOT)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${report_dir}/style.css ${report_dir}/style.gp)
configure_file(${report_dir}/assets.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp @ONLY)
target_sources(dynwitness_report PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp)
