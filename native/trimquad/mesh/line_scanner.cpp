#include <charconv>
#include <cmath>

#include "trimquad/base/error.h"
#include "trimquad/mesh/mesh_formats.h"

namespace trimquad {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

/// std::from_chars knows no leading plus sign.
std::string_view withoutPlus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  return text;
}

}  // namespace

std::string inQuotes(std::string_view token) {
  std::string text(token.substr(0, 24));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '.';
  return "\"" + text + (token.size() > 24 ? "..." : "") + "\"";
}

LineScanner::LineScanner(const MeshSource& source, std::size_t begin, std::size_t firstLine)
    : source_(source), next_(begin), line_(firstLine), nextLine_(firstLine) {}

bool LineScanner::nextLine() {
  const std::string& bytes = source_.bytes;
  while (next_ < bytes.size()) {
    std::size_t end = bytes.find_first_of("\r\n", next_);
    if (end == std::string::npos) end = bytes.size();
    text_ = std::string_view(bytes).substr(next_, end - next_);
    next_ = end;
    if (next_ < bytes.size()) next_ += bytes.compare(next_, 2, "\r\n") == 0 ? 2 : 1;
    line_ = nextLine_++;
    text_ = text_.substr(0, text_.find('#'));
    if (more()) return true;
  }
  text_ = {};
  return false;
}

bool LineScanner::more() {
  const std::size_t begin = text_.find_first_not_of(kBlanks);
  text_.remove_prefix(begin == std::string_view::npos ? text_.size() : begin);
  return !text_.empty();
}

std::string_view LineScanner::token() {
  if (!more()) return {};
  const std::size_t end = std::min(text_.find_first_of(kBlanks), text_.size());
  const std::string_view found = text_.substr(0, end);
  text_.remove_prefix(end);
  return found;
}

std::string_view LineScanner::rest() {
  if (!more()) return {};
  const std::string_view found = text_.substr(0, text_.find_last_not_of(kBlanks) + 1);
  text_ = {};
  return found;
}

double LineScanner::number(const char* what) {
  if (!more()) fail(std::string(what) + " is missing; the file is cut short or damaged");
  return toNumber(token(), what);
}

long long LineScanner::integer(const char* what) {
  if (!more()) fail(std::string(what) + " is missing; the file is cut short or damaged");
  return toInteger(token(), what);
}

double LineScanner::toNumber(std::string_view text, const char* what) const {
  const std::string_view digits = withoutPlus(text);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail(std::string(what) + " should be a number, but is " + inQuotes(text));
  if (error == std::errc::result_out_of_range) {
    const std::size_t exponent = digits.find_first_of("eE");
    if (exponent != std::string_view::npos && digits.substr(exponent + 1, 1) == "-") return 0;
    return INFINITY;
  }
  return value;
}

long long LineScanner::toInteger(std::string_view text, const char* what) const {
  const std::string_view digits = withoutPlus(text);
  long long value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size())
    fail(std::string(what) + " should be a whole number, but is " + inQuotes(text));
  return value;
}

}  // namespace trimquad
