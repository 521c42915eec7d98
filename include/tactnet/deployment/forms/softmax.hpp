#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/deployment/steps/softmax.hpp>
#include <tactnet/layers/softmax.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A form whose outputs become probabilities, where it writes those of the network.
template <class Form>
struct softmax_form {
    using step = softmax_within<typename Form::step>;
    static void fold(const parameter_source& list, float* to) { Form::fold(list, to); }
};
/// The same of a form that can write the outputs of a network.
template <class Form>
    requires requires {
        typename Form::leaving;
    }
struct softmax_form<Form> {
    /// Where others follow.
    using step = softmax_within<typename Form::step>;
    /// Where none follows.
    struct leaving {
        /// What the form does there, and the softmax.
        using step = softmax_behind<typename Form::leaving::step>;
        /// As the form itself.
        static void fold(const parameter_source& list, float* to) { Form::leaving::fold(list, to); }
    };
    /// As the form itself.
    static void fold(const parameter_source& list, float* to) { Form::fold(list, to); }
};

template <>
struct deployed_form<softmax> {
    /// See deployment/forms/form.hpp.
    template <class Form>
    using finishing = softmax_form<Form>;
    template <class Place>
    using at = form_without_parameters<
        softmax_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
