#include "gnn/physics/solver/crew.h"

#include <omp.h>

namespace cloth {

Crew::Crew()
    : m_first(static_cast<size_t>(omp_get_thread_num())),
      m_count(static_cast<size_t>(omp_get_num_threads())) {
}

void Crew::wait() {
#pragma omp barrier
}

}  // namespace cloth
