#pragma once

// A trunk: the layers of a network trained on photographs, up to the one whose values are features. It is
// compiled for the size of its photographs alone, which images of any size become, so that it is compiled
// once. The program knows trunks by this; see compile.hpp for the template behind it.

#include "methods/method.hpp"
#include "methods/photograph_networks.hpp"
#include "methods/trunks/features_form.hpp"

#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// A trunk with its weights, in its fastest form. Const calls may come from any number of threads.
class any_trunk {
public:
    virtual ~any_trunk() = default;
    /// A map for each photograph, one after the other, all [channel][row][column]: the same bits in any
    /// company and on any number of threads. False for maps that are not finite.
    virtual bool run(tactnet::thread_pool& threads, std::span<const float> photographs,
                     std::span<float> maps) const = 0;
};

/// What a trunk is called, here and elsewhere.
struct trunk_names {
    photograph_network network;
    std::string_view features; ///< the layer it ends in, as the paper's authors have it: "fire9-concat"
    /// How the names of arrays behind the trunk begin, which a file may hold or not.
    std::vector<std::string> behind;
};

/// The head of a frozen trunk, a network that is trained on its features: what is compiled of that.
struct compiled_head {
    std::string_view method;          ///< that trains it: "squeezenet-pooled-nn"
    trunk_features_form features;     ///< that it is trained on
    std::size_t outputs;              ///< the most classes that it can tell apart
    method_costs costs, costs_of_one; ///< with all outputs, and with one alone
    std::unique_ptr<tactnet::trainable> (*make)();
};

class compiled_trunk {
public:
    virtual ~compiled_trunk() = default;

    const trunk_names names;
    const tactnet::shape photograph, map;
    /// Of one photograph.
    const method_costs costs;
    const compiled_head head;

    /// By torchvision's names.
    virtual tactnet::stored_arrays arrays() const = 0;
    /// Reads the arrays, whose names begin with `prefix`. Throws tactnet::file_error.
    virtual std::unique_ptr<any_trunk> load(tactnet::safetensors_source& file,
                                            std::string_view prefix) const = 0;
    /// With weights by chance, of the usual size, to be timed.
    virtual std::unique_ptr<any_trunk> seeded() const = 0;

protected:
    compiled_trunk(trunk_names names_, tactnet::shape photograph_, tactnet::shape map_, method_costs costs_,
                   compiled_head head_)
        : names(std::move(names_)),
          photograph(photograph_),
          map(map_),
          costs(costs_),
          head(std::move(head_)) {}
};
