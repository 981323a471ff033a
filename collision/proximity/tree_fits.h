#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace cloth {

/// Copies of one tree, each fitted to a state of its own (a pose, or a motion between two). What
/// was handed out stays as it is while it is held; what nobody holds is fitted anew, so that a step
/// allocates nothing. As many are kept as the last step used, but no fewer than 16 and no more than
/// 256, so that several bodies of one mesh do not take each other's. One thread at a time may call
/// it; holders let go in any thread.
template <class Tree>
class TreeFits {
 public:
    using Held = std::shared_ptr<const Tree>;

    /// The fit for which matches(tree) is true; null: there is none.
    template <class Matches>
    Held find(long step, const Matches& matches) {
        for (auto fit = m_fits.begin(); fit != m_fits.end(); ++fit) {
            if (!matches(*fit->tree)) continue;
            if (fit->last_step != step) count_use(step);
            fit->last_step = step;
            std::rotate(fit, fit + 1, m_fits.end());
            return m_fits.back().tree;
        }
        return nullptr;
    }

    /// Whether nothing was added or prepared yet.
    bool is_empty() const { return m_fits.empty() && !m_spares->has(); }

    /// Of the tree that was used last; null: there is none.
    std::unique_ptr<Tree> copy() const {
        return m_fits.empty() ? m_spares->copy() : std::make_unique<Tree>(*m_fits.back().tree);
    }

    /// Keeps a tree for take(), and a copy: the first two steps find them there, and those that
    /// follow take turns with them. To copy one takes as long as ten fits.
    void prepare(std::unique_ptr<Tree> tree) {
        m_spares->put(std::make_unique<Tree>(*tree));
        m_spares->put(std::move(tree));
    }

    /// A tree to be fitted and added; null: there is none yet, build it.
    std::unique_ptr<Tree> take(long step) {
        const size_t most = std::clamp(used_before(step), least_fits, most_fits);
        while (m_fits.size() > 1 && (m_fits.front().last_step < step - 1 || m_fits.size() >= most))
            m_fits.erase(m_fits.begin());
        if (std::unique_ptr<Tree> spare = m_spares->take()) return spare;
        return copy();
    }

    Held add(long step, std::unique_ptr<Tree> tree) {
        const auto give_back = [spares = m_spares](Tree* done) {
            spares->put(std::unique_ptr<Tree>(done));
        };
        count_use(step);
        m_fits.push_back({std::shared_ptr<Tree>(tree.release(), give_back), step});
        return m_fits.back().tree;
    }

 private:
    static constexpr size_t least_fits = 16, most_fits = 256, most_spares = 2;

    /// Fits that were used in the step before this one.
    size_t used_before(long step) const {
        return step == m_step ? m_used_before : step == m_step + 1 ? m_used : 0;
    }

    void count_use(long step) {
        if (step != m_step) {
            m_used_before = used_before(step);
            m_used = 0;
            m_step = step;
        }
        ++m_used;
    }

    struct Fit {
        Held tree;
        long last_step;
    };

    /// Trees that nobody holds.
    class Spares {
     public:
        Spares() { m_trees.reserve(most_spares); }  // put() must not throw
        std::unique_ptr<Tree> take() {
            const std::lock_guard<std::mutex> lock(m_mutex);
            if (m_trees.empty()) return nullptr;
            std::unique_ptr<Tree> tree = std::move(m_trees.back());
            m_trees.pop_back();
            return tree;
        }
        bool has() {
            const std::lock_guard<std::mutex> lock(m_mutex);
            return !m_trees.empty();
        }
        std::unique_ptr<Tree> copy() {
            const std::lock_guard<std::mutex> lock(m_mutex);
            return m_trees.empty() ? nullptr : std::make_unique<Tree>(*m_trees.back());
        }
        void put(std::unique_ptr<Tree> tree) {
            const std::lock_guard<std::mutex> lock(m_mutex);
            if (m_trees.size() < most_spares) m_trees.push_back(std::move(tree));
        }

     private:
        std::mutex m_mutex;
        std::vector<std::unique_ptr<Tree>> m_trees;
    };

    std::vector<Fit> m_fits;   ///< the one that was used last comes last
    long m_step = 0;           ///< in which one was used last
    size_t m_used = 0;         ///< in that step
    size_t m_used_before = 0;  ///< in the one before it
    std::shared_ptr<Spares> m_spares = std::make_shared<Spares>();
};

}  // namespace cloth
