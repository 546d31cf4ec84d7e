#pragma once

#include <Eigen/Core>
#include <string>
#include <type_traits>
#include <vector>

namespace trimquad {

/// Values as bytes: the same for values that are the same, bit by bit. Values of different types or numbers
/// may have the same bytes; keys to compare are made of the same types in the same order.
class ByteKey {
 public:
  template <class Value>
  requires std::is_arithmetic_v<Value> || std::is_pointer_v<Value> ByteKey& add(Value value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <int Rows>
  ByteKey& add(const Eigen::Matrix<double, Rows, 1>& vector) {
    bytes_.append(reinterpret_cast<const char*>(vector.data()), Rows * sizeof(double));
    return *this;
  }
  ByteKey& add(const std::string& text) {
    add(text.size());
    bytes_ += text;
    return *this;
  }
  template <class Value>
  ByteKey& add(const std::vector<Value>& values) {
    add(values.size());
    for (const auto& value : values) add(value);
    return *this;
  }

  const std::string& bytes() const& { return bytes_; }
  std::string bytes() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

}  // namespace trimquad
