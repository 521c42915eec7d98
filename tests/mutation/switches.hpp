#pragma once

// Every mutant stands behind a switch, numbered at compile time and chosen by the environment
// (switch_main.cpp). mutate.py writes the switches into a copy of the headers: a < b becomes a <
// mutants::lt<17> < b, which keeps its precedence. While compiling, all switches are off.

#include <algorithm>
#include <initializer_list>
#include <type_traits>
#include <utility>

extern "C" {
extern int mutant_switched_on;
extern bool mutants_reached[];
}

#define MUTANT_INLINE __attribute__((always_inline)) inline constexpr

namespace mutants {

// The section lists the switches in the object code: code that never runs, but could, differs from code that
// runs only while compiling.
template <int N>
MUTANT_INLINE bool on() {
    if (std::is_constant_evaluated())
        return false;
    asm volatile(".pushsection .mutants,\"\",@progbits\n.long %c0\n.popsection" ::"i"(N));
    mutants_reached[N] = true;
    return mutant_switched_on == N;
}

template <int N, class T>
MUTANT_INLINE T number(T original, T changed) {
    return on<N>() ? changed : original;
}

template <int N>
MUTANT_INLINE bool flag(bool value) {
    return on<N>() ? !value : value;
}

#define MUTANT_EXTREMUM(name, other)                                                                         \
    template <int N, class T>                                                                                \
    MUTANT_INLINE T name(T const& a, T const& b) {                                                           \
        return on<N>() ? std::other<T>(a, b) : std::name<T>(a, b);                                           \
    }                                                                                                        \
    template <int N, class T>                                                                                \
    MUTANT_INLINE T name(std::initializer_list<T> all) {                                                     \
        return on<N>() ? std::other<T>(all) : std::name<T>(all);                                             \
    }
MUTANT_EXTREMUM(min, max)
MUTANT_EXTREMUM(max, min)

template <int N>
struct down_t {};
template <int N>
inline constexpr down_t<N> down{};
template <int N, class T>
MUTANT_INLINE void operator+=(down_t<N>, T& value) {
    if (on<N>())
        --value;
    else
        ++value;
}

#define MUTANT_OPERATOR(name, original, changed)                                                             \
    template <int N>                                                                                         \
    struct name##_t {};                                                                                      \
    template <int N>                                                                                         \
    inline constexpr name##_t<N> name{};                                                                     \
    template <int N, class A>                                                                                \
    struct name##_left {                                                                                     \
        A const& a;                                                                                          \
    };                                                                                                       \
    template <int N, class A>                                                                                \
    MUTANT_INLINE name##_left<N, A> operator original(A const& a, name##_t<N>) {                             \
        return {a};                                                                                          \
    }                                                                                                        \
    template <int N, class A, class B>                                                                       \
    MUTANT_INLINE auto operator original(name##_left<N, A> left, B const& b)->decltype(left.a original b) {  \
        if (on<N>())                                                                                         \
            return left.a changed b;                                                                         \
        return left.a original b;                                                                            \
    }
MUTANT_OPERATOR(lt, <, <=)
MUTANT_OPERATOR(le, <=, <)
MUTANT_OPERATOR(gt, >, >=)
MUTANT_OPERATOR(ge, >=, >)
MUTANT_OPERATOR(eq, ==, !=)
MUTANT_OPERATOR(ne, !=, ==)
MUTANT_OPERATOR(plus, +, -)
MUTANT_OPERATOR(minus, -, +)
MUTANT_OPERATOR(times, *, /)
MUTANT_OPERATOR(over, /, *)
MUTANT_OPERATOR(rest, %, /)

#define MUTANT_ASSIGNMENT(name, original, changed)                                                           \
    template <int N>                                                                                         \
    struct name##_t {};                                                                                      \
    template <int N>                                                                                         \
    inline constexpr name##_t<N> name{};                                                                     \
    template <int N, class B>                                                                                \
    struct name##_right {                                                                                    \
        B const& b;                                                                                          \
    };                                                                                                       \
    template <int N, class B>                                                                                \
    MUTANT_INLINE name##_right<N, B> operator original(name##_t<N>, B const& b) {                            \
        return {b};                                                                                          \
    }                                                                                                        \
    template <int N, class A, class B>                                                                       \
    MUTANT_INLINE A& operator original(A& a, name##_right<N, B> right) {                                     \
        if (on<N>())                                                                                         \
            a changed right.b;                                                                               \
        else                                                                                                 \
            a original right.b;                                                                              \
        return a;                                                                                            \
    }
MUTANT_ASSIGNMENT(add, +=, -=)
MUTANT_ASSIGNMENT(take, -=, +=)

} // namespace mutants
