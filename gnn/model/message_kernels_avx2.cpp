#define CLOTH_KERNELS avx2_kernels
#include "gnn/model/message_kernels.inl"
