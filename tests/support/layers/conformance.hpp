#pragma once

// What must hold of every layer, as one check: check_layer<conv2d<8, 5>, shape{28, 50, 1}>().
//
//  - costs and shapes: as in the reference, and as the described arrays add up
//  - results: inference and training within the derived bound of the reference, in both precisions
//  - gradients: in double against finite differences; of single layers also within the derived bound, or,
//    without a backward in the reference, in single precision beside those in double
//  - the same bits in any batch, at any place of it, with any number of threads, and in a memory used
//    before, even for something broken
//  - in place where the layer says so; its output is not read where it does not say so
//  - no heap in the second inference of a size

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <support/layers/conformance_options.hpp>
#include <support/layers/erased.hpp>
#include <support/layers/reference_of.hpp>
#include <vector>

namespace support {

struct conformance_subject {
    layer_maker<float> make_float;
    layer_maker<double> make_double;
    const reference_layer& reference;
    conformance_options options;
    const char* name; ///< for messages
};

void check_conformance(const conformance_subject& subject);

template <class Spec, tactnet::shape Input>
void check_layer(const conformance_options& options = {}) {
    const reference_pointer reference = reference_of<Spec>::on({Input.channels, Input.rows, Input.columns});
    check_conformance({&make_layer<Spec, float, Input>, &make_layer<Spec, double, Input>, *reference, options,
                       __PRETTY_FUNCTION__});
}

/// The arrays of a layer as texts, such as "layer.weight 6x2x3x3".
template <class Spec, tactnet::shape Input>
std::vector<std::string> arrays_of() {
    std::vector<std::string> texts;
    for (const tactnet::parameter& p : make_layer<Spec, float, Input>()->describe()) {
        std::string extents;
        for (const std::size_t extent : p.extents)
            extents += (extents.empty() ? " " : "x") + std::to_string(extent);
        texts.push_back(p.name + extents);
    }
    return texts;
}

} // namespace support
