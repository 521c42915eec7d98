#pragma once

#include "arrays.hpp"

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <array>
#include <cstddef>
#include <dlfcn.h>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

namespace tactnet_python {

/// A network's type: what has been compiled for it so far.
class compiled {
public:
    /// Adds what a shared library has. It stays loaded for as long as the program runs.
    void add(const std::string& path) {
        void* const library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
        const auto fill = library == nullptr
                              ? nullptr
                              : reinterpret_cast<void (*)(network_code*)>(dlsym(library, "tactnet_code"));
        if (fill == nullptr)
            throw std::runtime_error(path +
                                     ": expected a network that tactnet has compiled, found: " + dlerror());
        network_code more;
        fill(&more);
        if (more.instruction_set != tactnet::instruction_set)
            throw std::runtime_error(path + ": expected a network for " +
                                     std::string(tactnet::instruction_set) + ", found one for " +
                                     std::string(more.instruction_set) +
                                     ": compile the module and the network with the same CXXFLAGS");
        // Once: they are the same in each library, and a training in another thread may be reading them.
        if (code_.facts == nullptr && more.facts != nullptr)
            facts_ = more.facts();
        const auto merge = [&](auto network_code::*member) {
            if (more.*member != nullptr)
                code_.*member = more.*member;
        };
        merge(&network_code::facts), merge(&network_code::trainable), merge(&network_code::deploy);
        merge(&network_code::layout), merge(&network_code::calibrate), merge(&network_code::deploy_folded);
        merge(&network_code::stream), merge(&network_code::stream_in_8_bits);
        merge(&network_code::sensor), merge(&network_code::scene);
        merge(&network_code::discriminant), merge(&network_code::means);
    }
    const network_facts& facts() const { return facts_; }
    /// A function of the network's type, which the package has compiled before it calls.
    template <class Function>
    Function call(Function network_code::*member) const {
        if (code_.*member == nullptr)
            throw std::logic_error("tactnet._core: this part of the network has not been compiled");
        return code_.*member;
    }
    bool deploys() const { return code_.deploy != nullptr; }
    std::size_t pixels() const { return facts_.input.size(); }
    std::size_t outputs() const { return facts_.output.size(); }
    tactnet::stored_arrays arrays() const { return tactnet::stored_arrays_of(facts_.arrays, outputs()); }

private:
    network_code code_;
    network_facts facts_{};
};
using shared_code = std::shared_ptr<const compiled>;

inline void bind_code(py::module_& m) {
    const auto shape = [](const tactnet::shape& s) { return std::array{s.rows, s.columns, s.channels}; };
    py::class_<compiled, std::shared_ptr<compiled>> code(m, "Code");
    code.def(py::init()).def("add", &compiled::add);
    code.def_property_readonly(
        "input_shape", [=](const compiled& c) { return py::tuple(py::cast(shape(c.facts().input))); });
    code.def_property_readonly(
        "output_shape", [=](const compiled& c) { return py::tuple(py::cast(shape(c.facts().output))); });
    for (const auto& [name, member] :
         {std::pair("parameters", &network_facts::parameters),
          std::pair("statistics", &network_facts::statistics),
          std::pair("multiply_adds", &network_facts::multiply_adds),
          std::pair("multiply_adds_on_pixels", &network_facts::multiply_adds_on_pixels),
          std::pair("activation_bytes", &network_facts::activation_bytes)})
        code.def_property_readonly(name, [member = member](const compiled& c) { return c.facts().*member; });
    code.def_property_readonly("ends_in_softmax",
                               [](const compiled& c) { return c.facts().ends_in_softmax; });
    code.def_property_readonly("needs_counts", [](const compiled& c) { return c.facts().needs_counts; });
}

} // namespace tactnet_python
