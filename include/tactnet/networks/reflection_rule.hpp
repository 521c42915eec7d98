#pragma once

#include <tactnet/networks/recognition.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Which reflections of an image show a class, and which class: for most touches the same one. Where left and
/// right differ, the reflected image of a class shows its partner.
struct reflection_rule {
    /// What one axis allows.
    struct axis {
        bool reflects = false;               ///< whether reflected images show one of the classes at all
        std::vector<std::size_t> partners{}; ///< of each class; empty if each is its own

        /// The class that the reflected image of a class shows. What is no class (no_class) stays so.
        [[nodiscard]] std::size_t partner(std::size_t label) const {
            return label < partners.size() ? partners[label] : label;
        }
        friend bool operator==(const axis&, const axis&) = default;
    };
    axis rows, columns;

    /// Each class is its own partner in all reflections.
    [[nodiscard]] static reflection_rule all() { return {{.reflects = true}, {.reflects = true}}; }
    [[nodiscard]] reflection axes() const { return {rows.reflects, columns.reflects}; }
    /// The class that the reflected image of a class shows.
    [[nodiscard]] std::size_t partner(reflection how, std::size_t label) const {
        const std::size_t upright = how.rows ? rows.partner(label) : label;
        return how.columns ? columns.partner(upright) : upright;
    }
    /// Writes the mean of outputs over the images that it allows. `outputs_of(r)` is a row of outputs for
    /// all_reflections[r], of a network with `to.size()` outputs.
    template <class OutputsOf>
    void average(const OutputsOf& outputs_of, std::span<float> to) const {
        for (std::size_t e = 0; e < to.size(); ++e)
            to[e] = mean_of_reflections(axes(), [&](std::size_t r) -> float {
                return outputs_of(r)[partner(all_reflections[r], e)];
            });
    }
    friend bool operator==(const reflection_rule&, const reflection_rule&) = default;
};

}} // namespace tactnet
