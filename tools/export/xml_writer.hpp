#pragma once

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <functional>
#include <string>

#include "planner/problem/document_builder.hpp"

namespace mvtp {

/// Writes XML as nested calls: the elements of `inside` stand in `name`. Numbers have no exponent,
/// as the type "decimal" of XML schemas demands. Texts that XML cannot hold are refused.
class XmlWriter {
 public:
  XmlWriter() { printer_.PushHeader(/*writeBOM=*/false, /*writeDeclaration=*/true); }

  void element(const char* name, const std::function<void()>& inside) {
    printer_.OpenElement(name);
    inside();
    printer_.CloseElement();
  }
  /// <name>text</name>
  void text(const char* name, const std::string& text) {
    element(name, [&] { printer_.PushText(checked(text).c_str()); });
  }
  void number(const char* name, double value, int digits = 4) { text(name, fixed(value, digits)); }

  // Of the element that was opened last, before anything is inside.
  void attribute(const char* name, const std::string& value) {
    printer_.PushAttribute(name, checked(value).c_str());
  }
  void attribute(const char* name, double value, int digits = 4) {
    printer_.PushAttribute(name, fixed(value, digits).c_str());
  }
  void comment(const std::string& text) { printer_.PushComment(checked(text).c_str()); }

  [[nodiscard]] std::string str() const { return {printer_.CStr()}; }

  [[nodiscard]] static std::string fixed(double value, int digits) {
    return fmt::format("{:.{}f}", value, digits);
  }

 private:
  /// XML 1.0 has no way to write most control characters. @throws InputError
  static const std::string& checked(const std::string& text) {
    const auto is_control = [](unsigned char c) {
      return c < 0x20 && c != '\t' && c != '\n' && c != '\r';
    };
    if (std::ranges::none_of(text, is_control)) return text;
    throw InputError(excerpt(text),
                     "has a control character, which XML cannot hold; choose another name");
  }

  tinyxml2::XMLPrinter printer_;
};

}  // namespace mvtp
