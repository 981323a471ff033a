// Compiled by a test with BT_USE_DOUBLE_PRECISION: the header has to refuse it.
#include "bullet_ext/btGnnSoftBodySolver.h"
