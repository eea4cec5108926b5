/// What lets one header of pure functions compile both as C++20 (with GLM) and as GLSL 4.5.
///
/// A formula header uses float literals with the suffix f, structs returned by value and filled field by field,
/// value parameters; no references, templates, namespaces of its own, default arguments or standard headers.
#ifndef MENISCUS_FORMULAS_GLSL_SUBSET_H
#define MENISCUS_FORMULAS_GLSL_SUBSET_H

#ifdef __cplusplus
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#define FORMULA inline
#define FORMULAS_BEGIN          \
  namespace meniscus::formulas { \
  using glm::abs;               \
  using glm::asin;              \
  using glm::clamp;             \
  using glm::cross;             \
  using glm::dot;               \
  using glm::exp;               \
  using glm::length;            \
  using glm::log;               \
  using glm::mat3;              \
  using glm::max;               \
  using glm::min;               \
  using glm::mix;               \
  using glm::normalize;         \
  using glm::pow;               \
  using glm::sqrt;              \
  using glm::vec2;              \
  using glm::vec3;
#define FORMULAS_END }
#else
#define FORMULA
#define FORMULAS_BEGIN
#define FORMULAS_END
#endif

#endif
