// A file with FastCloth's Eigen calls a library that was compiled with another.
#include "analysis.h"
#include "data/core/types.h"

int main() {
    return mean(cloth::VectorX::Ones(5)) == 1 ? 0 : 1;
}
