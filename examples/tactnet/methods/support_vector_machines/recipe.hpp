#pragma once

#include "methods/support_vector_machines/machine.hpp"

#include <array>
#include <string_view>
#include <variant>

/// Of a support vector machine: which one, what it is trained with and what stands before it.
struct svm_recipe {
    std::string_view name;
    std::variant<linear_options, rbf_options> options;
    float pixel_scale; ///< 0: not pixels but words

    bool is_linear() const { return std::holds_alternative<linear_options>(options); }

    /// All but the images that decides what comes of a training, features apart.
    tactnet::file_metadata describe() const;
};

const std::array<svm_recipe, 3>& svm_recipes();
