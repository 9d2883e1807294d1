#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>
#include <vector>

#include "planner/problem/pose.hpp"

namespace mvtp {

/// One of SUMO's XML files in memory; every error names the file and the line.
class XmlFile {
 public:
  /// Throws InputError unless `path` is a readable, well-formed XML file; `what` it should be (for
  /// messages), e.g. "a SUMO network".
  XmlFile(std::string path, const std::string& what);

  [[nodiscard]] const tinyxml2::XMLElement& root() const { return *document_.RootElement(); }

  /// The attribute as text; throws InputError if it is missing.
  [[nodiscard]] std::string text(const tinyxml2::XMLElement& element, const char* name) const;
  /// The attribute as a finite number; throws InputError if it is missing or none.
  [[nodiscard]] double number(const tinyxml2::XMLElement& element, const char* name) const;
  /// The same with a value for a missing attribute.
  [[nodiscard]] double number(const tinyxml2::XMLElement& element, const char* name,
                              double fallback) const;
  /// As number(), but > 0.
  [[nodiscard]] double positive(const tinyxml2::XMLElement& element, const char* name,
                                std::optional<double> fallback = std::nullopt) const;
  /// The attribute as an index >= 0.
  [[nodiscard]] int index(const tinyxml2::XMLElement& element, const char* name) const;
  /// The attribute as a list of "x,y" or "x,y,z".
  [[nodiscard]] std::vector<Point> points(const tinyxml2::XMLElement& element,
                                          const char* name) const;

  /// The file and the element's line.
  [[nodiscard]] std::string where(const tinyxml2::XMLElement& element) const;
  /// Throws an InputError that names the file and the element's line.
  [[noreturn]] void fail(const tinyxml2::XMLElement& element, const std::string& problem) const;

 private:
  [[noreturn]] void fail(const tinyxml2::XMLElement& element, const char* attribute,
                         const std::string& problem) const;

  std::string path_;
  tinyxml2::XMLDocument document_;
};

/// The attribute as text, "" if it is missing.
[[nodiscard]] std::string attribute(const tinyxml2::XMLElement& element, const char* name);

/// The child elements called `name`, in the order of the file.
[[nodiscard]] std::vector<const tinyxml2::XMLElement*> children(const tinyxml2::XMLElement& parent,
                                                                const char* name);

/// The words of a text between any of the `separators`; empty ones are dropped.
[[nodiscard]] std::vector<std::string> split(const std::string& text, const char* separators);

/// The whole text as a finite number.
[[nodiscard]] std::optional<double> parse_number(const std::string& text);

/// Throws InputError unless `path` is a regular file that can be read.
void check_readable(const std::string& path, const std::string& what);

}  // namespace mvtp
