#pragma once

/// Lets a sheet fall on a ball, moved by the learned solver, and by the default one.
/// @return  whether it lies on it
bool cloth_falls_on_a_ball();
