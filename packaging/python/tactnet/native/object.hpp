#pragma once

#include "objects.hpp"

#include <tactnet/decision/fit_discriminant.hpp>

#include <type_traits>

namespace tactnet_python {

/// An object of the library behind its interface, and its state.
template <class Interface, class Object>
class object_behind : public Interface {
public:
    std::vector<std::byte> state() const override {
        std::vector<std::byte> bytes(Object::state_bytes);
        own_->save(std::span(bytes).template first<Object::state_bytes>());
        return bytes;
    }
    tactnet::restore_status restore(std::span<const std::byte> state) override {
        return own_->restore(state);
    }

protected:
    std::unique_ptr<Object> own_ = std::make_unique<Object>();
};

template <class Object>
class object_of;
template <std::size_t Features, std::size_t Dimensions>
class object_of<tactnet::discriminant<Features, Dimensions>> final
    : public object_behind<any_discriminant, tactnet::discriminant<Features, Dimensions>> {
public:
    object_of() { this->features = Features, this->dimensions = Dimensions; }
    void fit(std::span<const float> rows, std::span<const std::size_t> labels, std::size_t classes,
             double shrinkage) override {
        this->own_ = tactnet::fit_discriminant<Features, Dimensions>(rows, labels, classes, shrinkage);
    }
    void project(std::span<const float> row, std::span<float> to) const override {
        std::ranges::copy(this->own_->project(row.first<Features>()), to.begin());
    }
};
template <std::size_t Dimensions, std::size_t MostClasses>
class object_of<tactnet::class_means<Dimensions, MostClasses>> final
    : public object_behind<any_means, tactnet::class_means<Dimensions, MostClasses>> {
    using point = typename tactnet::class_means<Dimensions, MostClasses>::point;

public:
    object_of() { this->dimensions = Dimensions, this->most_classes = MostClasses; }
    bool learn(std::size_t index, std::span<const float> touch) override {
        return this->own_->learn(index, point_of(touch));
    }
    void forget(std::size_t index) override { this->own_->forget(index); }
    std::size_t touches(std::size_t index) const override { return this->own_->touches(index); }
    double spread(std::size_t index) const override { return this->own_->spread(index); }
    std::optional<tactnet::nearest_class> nearest(std::span<const float> touch) const override {
        return this->own_->nearest(point_of(touch));
    }

private:
    static point point_of(std::span<const float> touch) {
        point copy;
        std::copy_n(touch.begin(), Dimensions, copy.begin());
        return copy;
    }
};

template <class Object>
network_code code_of_object() {
    network_code code;
    if constexpr (std::is_base_of_v<any_means, object_of<Object>>)
        code.means = []() -> std::unique_ptr<any_means> { return std::make_unique<object_of<Object>>(); };
    else
        code.discriminant = []() -> std::unique_ptr<any_discriminant> {
            return std::make_unique<object_of<Object>>();
        };
    return code;
}

} // namespace tactnet_python
