# cmake -DSOURCE=<folder> -DOUTPUT=<file.cpp> -P commit.cmake: writes build_commit() of
# demos/provenance/provenance.h. The file is touched only where the commit has changed.
find_program(GIT git)
set(commit "unknown")
get_filename_component(above "${SOURCE}" DIRECTORY)
# A copy without .git inside another project's repository is not of that project.
set(ENV{GIT_CEILING_DIRECTORIES} "${above}")
if(GIT)
  execute_process(COMMAND ${GIT} rev-parse --short=10 HEAD
                  WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE head RESULT_VARIABLE failed
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(commit "${head}")
    execute_process(COMMAND ${GIT} --no-optional-locks status --porcelain --untracked-files=no -- .
                            ":(exclude)*.md" ":(exclude)data/assets/figures"
                    WORKING_DIRECTORY "${SOURCE}" OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      string(APPEND commit "-dirty")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUTPUT}" @ONLY CONTENT [=[
#include "demos/provenance/provenance.h"

std::string cloth::build_commit() {
    return "@commit@";
}
]=])
