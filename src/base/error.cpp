#include <fmt/format.h>

#include "meniscus/base.h"

namespace meniscus {
namespace {

std::string joined(const ErrorDetail& detail) {
  std::string text;
  if (!detail.path.empty()) {
    text += detail.path;
    if (detail.line) text += fmt::format(":{}", *detail.line);
    text += ": ";
  }
  text += detail.problem;
  std::string in_brackets;
  const auto append = [&](const std::string& part) {
    if (!in_brackets.empty()) in_brackets += ", ";
    in_brackets += part;
  };
  if (!detail.expected.empty()) append("expected " + detail.expected);
  if (!detail.found.empty()) append("found " + detail.found);
  if (detail.byte_offset) append(fmt::format("at byte {}", *detail.byte_offset));
  if (!in_brackets.empty()) text += " (" + in_brackets + ")";
  if (!detail.advice.empty()) text += "; " + detail.advice;
  return text;
}

}  // namespace

Error::Error(ErrorCode code, ErrorDetail detail)
    : std::runtime_error(joined(detail)), code_(code), detail_(std::move(detail)) {}

}  // namespace meniscus
