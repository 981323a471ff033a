#define CLOTH_KERNELS avx512_kernels
#include "gnn/model/message_kernels.inl"
