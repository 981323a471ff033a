#pragma once

#include "demos/viewer/options.h"

namespace cloth {

/// Opens a window and stays in it until it is closed, or the options' steps are done.
/// @throws std::runtime_error where there is no display or no OpenGL 3.3; UsageError, LoadError,
///         ArgumentError if the scene cannot be had or the screenshot not be written
void run_viewer(const ViewerOptions& options);

}  // namespace cloth
