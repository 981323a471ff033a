# Most of the time to compile a file here goes into Eigen's headers. They are compiled once for the
# libraries that use OpenMP and once for the others.
set(headers <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <functional> <map> <memory> <string>
            <vector>)
set(serial cloth_core cloth_files cloth_body cloth_graph cloth_bullet cloth_render cloth_compare)
set(parallel cloth_collision cloth_physics cloth_model)
target_precompile_headers(cloth_core PRIVATE ${headers})
target_precompile_headers(cloth_collision PRIVATE ${headers})
foreach(target ${serial} ${parallel})
  # Files with flags of their own read what they need themselves: headers that are compiled for
  # another instruction set must not get into them.
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  list(TRANSFORM sources PREPEND ${folder}/)
  foreach(source ${sources})
    get_source_file_property(options ${source} TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
    if(options)
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES
                                  SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
  if(target IN_LIST serial AND NOT target STREQUAL cloth_core)
    target_precompile_headers(${target} REUSE_FROM cloth_core)
  elseif(target IN_LIST parallel AND NOT target STREQUAL cloth_collision)
    target_precompile_headers(${target} REUSE_FROM cloth_collision)
  endif()
endforeach()
