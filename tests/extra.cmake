# Tests of the project's form rather than of one stage: what includes what, headers that stand alone, formulas
# that are GLSL too, citations, and the installed package.
find_program(MENISCUS_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
find_program(MENISCUS_GLSLC glslc REQUIRED)
set(generated_dir ${CMAKE_CURRENT_BINARY_DIR}/generated)

# What includes what, and that nothing is downloaded; citation keys. Each check is itself checked on made-up trees.
function(add_project_check name)
  add_test(NAME project.${name} COMMAND ${MENISCUS_PYTHON} -B ${CMAKE_SOURCE_DIR}/tools/${name}.py ${CMAKE_SOURCE_DIR})
  add_test(NAME project.${name}_finds_each_kind_of_fault
    COMMAND ${MENISCUS_PYTHON} -B ${CMAKE_SOURCE_DIR}/tools/${name}_test.py)
endfunction()
add_project_check(check_stages)
add_project_check(check_references)

# Each public header compiles alone, with nothing but what meniscus::meniscus hands on: one .cpp a header, which
# includes it twice. A header that does not stops the build.
file(GLOB_RECURSE public_headers RELATIVE ${CMAKE_SOURCE_DIR}/include CONFIGURE_DEPENDS
  ${CMAKE_SOURCE_DIR}/include/meniscus/*.h)
set(alone_sources)
foreach(header IN LISTS public_headers)
  string(MAKE_C_IDENTIFIER ${header} name)
  set(source ${generated_dir}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "#include \"${header}\"\n#include \"${header}\"\n" @ONLY)
  list(APPEND alone_sources ${source})
endforeach()
add_library(headers_alone OBJECT ${alone_sources})
target_include_directories(headers_alone PRIVATE ${CMAKE_SOURCE_DIR}/include)
target_link_libraries(headers_alone PRIVATE glm::glm meniscus_warnings)

# Each header of formulas is GLSL as well. The last test shows that glslc does refuse what is not.
function(add_glsl_test name header)
  file(CONFIGURE OUTPUT ${generated_dir}/${name}.comp CONTENT "#version 450
#extension GL_GOOGLE_include_directive : require
#include \"${header}\"
void main() {}
" @ONLY)
  add_test(NAME project.glsl.${name} COMMAND ${MENISCUS_GLSLC} -Werror -I ${CMAKE_SOURCE_DIR}/include
    -o ${generated_dir}/${name}.spv ${generated_dir}/${name}.comp)
endfunction()
foreach(header IN LISTS public_headers)
  if(header MATCHES "^meniscus/formulas/(.*)[.]h$")
    string(MAKE_C_IDENTIFIER ${CMAKE_MATCH_1} name)
    add_glsl_test(${name} ${header})
  endif()
endforeach()
add_glsl_test(is_not_any_cpp meniscus/base.h)
set_tests_properties(project.glsl.is_not_any_cpp PROPERTIES WILL_FAIL TRUE)

# What is installed serves a program outside of this tree.
add_test(NAME project.installed_package_serves_an_outside_program
  COMMAND ${CMAKE_COMMAND} -D build_dir=${CMAKE_BINARY_DIR} -D work_dir=${CMAKE_CURRENT_BINARY_DIR}/install
    -D generator=${CMAKE_GENERATOR} -D compiler=${CMAKE_CXX_COMPILER} -D flags=${CMAKE_CXX_FLAGS}
    -D build_type=${CMAKE_BUILD_TYPE} -P ${CMAKE_CURRENT_SOURCE_DIR}/install/run.cmake)
set_tests_properties(project.installed_package_serves_an_outside_program PROPERTIES TIMEOUT 300)
