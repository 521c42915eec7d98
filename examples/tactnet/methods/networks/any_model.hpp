#pragma once

// Networks of any type, with all that it takes to recognise.

#include "methods/method.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

struct any_model {
    std::unique_ptr<tactnet::trainable> network;
    std::vector<float> mean;
    float scale = 1;
    std::vector<std::string> classes;
};

/// The values of each array, in the order of `describe`.
std::vector<std::span<float>> arrays_of(tactnet::trainable& network);

/// The model as a file has it, without what it tests itself with. A view of the model; `image` is what the
/// file's images are.
tactnet::model_parts parts_of(const any_model& model, tactnet::shape image, tactnet::stored_arrays arrays);

/// Takes what a file holds. Rows of outputs that stand for no class become zero; where no mean is stored, it
/// is zero.
void take(any_model& model, tactnet::stored_model stored);

/// Parameters by chance, to be timed.
void draw_arrays(tactnet::trainable& network);

/// A row for each of `count` samples, with one number a class. make(i, numbers) writes sample i: counts, or
/// features.
std::vector<float> logits_of(const any_model& model, std::size_t count,
                             const std::function<void(std::size_t, std::span<float>)>& make);

/// Throws std::runtime_error: logits are not finite.
[[noreturn]] void refuse_logits();

/// Of rows of `outputs` logits or probabilities, of which those of `classes` count. Throws
/// std::runtime_error for some that are not finite.
std::vector<scored_class> classes_of_rows(std::span<const float> rows, std::size_t outputs,
                                          std::size_t classes, bool are_probabilities = false);

/// The costs of a network for a number of classes, from those with all its outputs and with one alone:
/// outputs that stand for no class are no part of the network, and each costs the same.
method_costs costs_for(const method_costs& all, const method_costs& one, std::size_t outputs,
                       std::size_t classes);
