cmake_minimum_required(VERSION 3.24)

# run(WHAT EXPECTED COMMAND...): EXPECTED is "works", or what the output of a failure has to match.
# What the command printed is in run_output.
function(run what expected)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(expected STREQUAL "works" AND NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  elseif(NOT expected STREQUAL "works" AND (result EQUAL 0 OR NOT output MATCHES "${expected}"))
    message(FATAL_ERROR "${what} did not fail with '${expected}':\n${output}")
  endif()
  message("${what}: as expected")
  set(run_output "${output}" PARENT_SCOPE)
endfunction()

# Where pkg-config finds the installation.
file(GLOB_RECURSE pc ${PREFIX}/fastcloth.pc)
if(pc)
  get_filename_component(pc_folder ${pc} DIRECTORY)
  set(ENV{PKG_CONFIG_PATH} ${pc_folder})
endif()
