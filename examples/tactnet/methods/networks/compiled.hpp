#pragma once

// All of a network that is compiled for its type and size, as virtual functions. The program knows networks
// by this alone, so that everything else is compiled once. See compile.hpp for the template behind it.

#include "methods/method.hpp"
#include "methods/networks/any_model.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The fastest form of a network, see tactnet::deploy.
class any_deployed {
public:
    virtual ~any_deployed() = default;
    /// As many rows of outputs as frames, for frames one after the other. False for outputs that are not
    /// finite.
    virtual bool recognise(tactnet::thread_pool& threads, std::span<const std::uint8_t> frames,
                           std::span<float> outputs) const = 0;
    /// Whether outputs are probabilities, of a network that ends in a softmax; else they are logits.
    virtual bool gives_probabilities() const = 0;
    /// See tactnet::deployed_header.
    virtual std::string header(const tactnet::header_description& says,
                               std::span<const std::uint8_t> frame) const = 0;
};

class compiled_network {
public:
    virtual ~compiled_network() = default;

    const std::size_t rows, columns, outputs;
    /// With all outputs, and with one alone.
    const method_costs costs, costs_of_one;
    const bool takes_counts; ///< see tactnet::basic_network

    virtual std::unique_ptr<tactnet::trainable> make() const = 0;
    /// All that decides what it computes, as the compiler spells its type.
    virtual std::string_view type() const = 0;
    /// Its arrays, without one of them being made.
    virtual std::vector<tactnet::parameter> describe() const = 0;
    /// Throws std::invalid_argument for parameters that cannot be deployed.
    virtual std::unique_ptr<any_deployed> deploy(const any_model& model) const = 0;
    /// How images of that size are varied and reduced; null where that was not compiled in.
    virtual tactnet::images_as_taken::variation variation_of(const tactnet::shape& taken) const = 0;

protected:
    compiled_network(std::size_t rows_, std::size_t columns_, std::size_t outputs_, method_costs costs_,
                     method_costs costs_of_one_, bool takes_counts_)
        : rows(rows_),
          columns(columns_),
          outputs(outputs_),
          costs(costs_),
          costs_of_one(costs_of_one_),
          takes_counts(takes_counts_) {}
};
