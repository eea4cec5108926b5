#include "io/where.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/attributes.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
         c == ':' || static_cast<unsigned char>(c) >= 0x80;
}

std::string listed(const Particles& particles) {
  std::string list = "x, y, z";
  for (const Attribute& attribute : particles.attributes)
    list += attribute.components == 1 ? fmt::format(", {}", attribute.name)
                                      : fmt::format(", {}[0..{}]", attribute.name, attribute.components - 1);
  return list;
}

/// The attribute of a name, in any case, or of its common name.
const Attribute* attribute_of(const Particles& particles, const std::string& name) {
  if (const Attribute* exact = particles.find(name)) return exact;
  for (const int components : {0, 1, 3}) {
    const std::string plain = lower(components == 0 ? name : common_name(name, components));
    for (const Attribute& attribute : particles.attributes)
      if (lower(attribute.name) == plain) return &attribute;
  }
  return nullptr;
}

}  // namespace

/// Reads a condition from left to right.
class ConditionParser {
 public:
  explicit ConditionParser(std::string_view text) : text_(text) {}

  std::vector<std::vector<Condition::Comparison>> alternatives() {
    std::vector<std::vector<Condition::Comparison>> all(1);
    while (true) {
      all.back().push_back(comparison());
      skip_blanks();
      if (at_ == text_.size()) return all;
      if (take("||")) {
        all.emplace_back();
      } else if (!take("&&")) {
        fail("&&, || or the end");
      }
    }
  }

 private:
  [[noreturn]] void fail(std::string expected, std::string advice = {}) const {
    if (advice.empty()) advice = "a condition is, say: type==3 && density>=900 || mk!=11";
    throw Error(ErrorCode::invalid_argument,
                {fmt::format("the condition '{}' cannot be understood at character {}", text_, at_ + 1),
                 std::move(expected),
                 at_ < text_.size() ? fmt::format("'{}'", text_.substr(at_, 20)) : std::string("the end"),
                 {},
                 {},
                 {},
                 std::move(advice)});
  }

  void skip_blanks() {
    while (at_ < text_.size() && is_blank(text_[at_])) ++at_;
  }

  bool take(std::string_view token) {
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }

  Condition::Comparison comparison() {
    Condition::Comparison result;
    skip_blanks();
    if (at_ < text_.size() && (text_[at_] == '(' || text_[at_] == '!'))
      fail("the name of an attribute", "there are no parentheses: && binds tighter than ||");
    result.name = name();
    skip_blanks();
    if (take("[")) result.component = component();
    skip_blanks();
    result.how = comparing();
    skip_blanks();
    result.value = number();
    return result;
  }

  std::string name() {
    if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) {
      const std::size_t end = text_.find(text_[at_], at_ + 1);
      if (end == std::string_view::npos) fail("a closing quote");
      const std::string_view quoted = text_.substr(at_ + 1, end - at_ - 1);
      at_ = end + 1;
      return std::string(quoted);
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && is_name_character(text_[at_])) ++at_;
    if (at_ == start) fail("the name of an attribute");
    return std::string(text_.substr(start, at_ - start));
  }

  std::size_t component() {
    const std::size_t start = at_;
    while (at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9') ++at_;
    std::uint64_t value = 0;
    if (!parse_count(text_.substr(start, at_ - start), value)) fail("the number of a component, from 0");
    if (!take("]")) fail("]");
    return value;
  }

  Condition::Operator comparing() {
    using enum Condition::Operator;
    constexpr std::pair<std::string_view, Condition::Operator> kOperators[] = {
        {"==", equal}, {"!=", unequal}, {"<=", less_equal}, {">=", greater_equal}, {"<", less}, {">", greater}};
    for (const auto& [token, how] : kOperators)
      if (take(token)) return how;
    fail("==, !=, <, <=, > or >=");
  }

  double number() {
    const std::size_t start = at_;
    while (at_ < text_.size() && (is_name_character(text_[at_]) || text_[at_] == '-' || text_[at_] == '+')) ++at_;
    double value = 0;
    if (parse_number(text_.substr(start, at_ - start), value)) return value;
    at_ = start;
    fail("a number");
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

Condition::Condition(std::string_view text) : alternatives_(ConditionParser(text).alternatives()) {}

Condition::Numbers Condition::numbers_of(const Comparison& comparison, const Particles& particles) {
  std::string name = comparison.name;
  std::optional<std::size_t> component = comparison.component;
  const Attribute* attribute = attribute_of(particles, name);
  if (attribute == nullptr && !component) {
    // vx, Vel.x, y: components by a name of their own.
    if (const std::optional<Component> part = component_of(name)) {
      name = part->base;
      component = static_cast<std::size_t>(part->index);
      attribute = attribute_of(particles, name);
    }
  }
  if (attribute == nullptr && name == "position" && component && *component < 3) {
    const std::vector<float>& axis = *component == 0 ? particles.x : *component == 1 ? particles.y : particles.z;
    return {axis.data(), 1, particles.origin[static_cast<glm::length_t>(*component)]};
  }
  const auto refuse = [&](std::string problem) {
    throw Error(ErrorCode::invalid_argument, {std::move(problem), listed(particles), {}, {}, {}, {}, {}});
  };
  if (attribute == nullptr) refuse(fmt::format("particles have no '{}' to choose by", comparison.name));
  const auto components = static_cast<std::size_t>(attribute->components);
  if (!component && components != 1)
    refuse(fmt::format("'{}' has {} components: choose by one, {}[0]", comparison.name, components, comparison.name));
  if (component && *component >= components)
    refuse(fmt::format("'{}' has no component {}", comparison.name, *component));
  return {attribute->values.data() + component.value_or(0), components, 0};
}

bool Condition::holds(const Comparison& comparison, const Numbers& numbers, std::size_t particle) {
  const float stored = numbers.first[particle * numbers.stride];
  // Attributes are floats: 0.1 is meant to equal the float nearest to it.
  const bool wide = numbers.origin != 0;
  const double value = wide ? static_cast<double>(stored) + numbers.origin : static_cast<double>(stored);
  const double limit = wide ? comparison.value : static_cast<double>(static_cast<float>(comparison.value));
  switch (comparison.how) {
    case Operator::equal:
      return value == limit;
    case Operator::unequal:
      return value != limit;
    case Operator::less:
      return value < limit;
    case Operator::less_equal:
      return value <= limit;
    case Operator::greater:
      return value > limit;
    case Operator::greater_equal:
      break;
  }
  return value >= limit;
}

void Condition::judge(const Particles& particles, std::span<std::uint8_t> fits) const {
  std::vector<std::vector<Numbers>> numbers;
  for (const auto& all : alternatives_) {
    numbers.emplace_back();
    for (const Comparison& comparison : all) numbers.back().push_back(numbers_of(comparison, particles));
  }
  parallel_for(fits.size(), 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      bool any = false;
      for (std::size_t a = 0; a < alternatives_.size() && !any; ++a) {
        any = true;
        for (std::size_t c = 0; c < alternatives_[a].size() && any; ++c)
          any = holds(alternatives_[a][c], numbers[a][c], i);
      }
      fits[i] = any ? 1 : 0;
    }
  });
}

}  // namespace meniscus::io
