#pragma once

#include <tactnet/detail/config.hpp>

#include <memory>
#include <type_traits>
#include <utility>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

template <class Signature>
class function_ref;

/// A reference to a callable, for functions that call it before they return: std::function without a copy or
/// the heap, and with little to compile (std::function_ref of C++26).
template <class Result, class... Arguments>
class function_ref<Result(Arguments...)> {
public:
    template <class Callable>
        requires(!std::is_same_v<std::remove_cvref_t<Callable>, function_ref> &&
                 std::is_invocable_r_v<Result, Callable&, Arguments...>)
    function_ref(Callable&& callable) noexcept
        : object_(const_cast<void*>(static_cast<const void*>(std::addressof(callable)))),
          call_([](void* object, Arguments... arguments) -> Result {
              return (*static_cast<std::remove_reference_t<Callable>*>(object))(
                  std::forward<Arguments>(arguments)...);
          }) {}

    Result operator()(Arguments... arguments) const {
        return call_(object_, std::forward<Arguments>(arguments)...);
    }

private:
    void* object_;
    Result (*call_)(void*, Arguments...);
};

}}} // namespace tactnet::detail
