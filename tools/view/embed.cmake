# cmake -DSOURCE_DIR=... -DSCRIPTS=a.js,b.js -DOUTPUT=page_template.cpp -P embed.cmake
# Puts page.css and the scripts into page.html and the page into a C++ string.
file(READ "${SOURCE_DIR}/page.html" page)
file(READ "${SOURCE_DIR}/page.css" style)
string(REPLACE "," ";" scripts "${SCRIPTS}")
set(script "")
foreach(file IN LISTS scripts)
  file(READ "${SOURCE_DIR}/${file}" text)
  string(APPEND script "${text}\n")
endforeach()
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")
file(WRITE "${OUTPUT}"
  "#include \"tools/view/page_template.hpp\"\n"
  "namespace mvtp {\n"
  "const std::string_view kPageTemplate = R\"__page__(${page})__page__\";\n"
  "}  // namespace mvtp\n")
