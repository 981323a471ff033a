#define CLOTH_KERNELS portable_kernels
#include "gnn/model/message_kernels.inl"
