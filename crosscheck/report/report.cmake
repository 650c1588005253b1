# What the report needs beyond its sources: its style sheets, prose and script inside the program. Included once, after
# the target dynwitness_report is there.
set(report_dir ${CMAKE_CURRENT_LIST_DIR})
file(READ ${report_dir}/style.css DYNWITNESS_STYLE_CSS)
file(READ ${report_dir}/style.gp DYNWITNESS_STYLE_GNUPLOT)
file(READ ${report_dir}/how_to_read.html DYNWITNESS_HOW_TO_READ_HTML)
file(READ ${report_dir}/view.css DYNWITNESS_VIEW_CSS)
file(READ ${report_dir}/view.js DYNWITNESS_VIEW_JS)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS
  ${report_dir}/style.css ${report_dir}/style.gp ${report_dir}/how_to_read.html
  ${report_dir}/view.css ${report_dir}/view.js)
configure_file(${report_dir}/assets.cpp.in ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp @ONLY)
target_sources(dynwitness_report PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp)
