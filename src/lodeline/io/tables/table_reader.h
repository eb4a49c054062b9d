#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/column_name.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

struct TableOptions {
  /// Whether these names are a header that the caller can use. The first line for which this is true is the
  /// header, whether it is a comment or not. Otherwise, the table has no header.
  std::function<bool(const std::vector<ColumnName>&)> is_header;
  /// Kind of the finding for a skipped row.
  std::string finding = "csv_row";
  /// Minimum number of cells of the first row, which defines the number of columns where there is no header.
  std::size_t least_columns = 1;
  /// Number of cells that a row may lack at its end; they are then empty.
  std::size_t optional_columns = 0;
  /// Whether a table without any fitting row is an error instead of an empty table.
  bool needs_rows = true;
  /// Whether a row with another number of cells is an error instead of being skipped. A truncated last row is
  /// never an error.
  bool refuses_misfits = false;
  /// Whether a line of words below the header states the units. Otherwise, it is a row.
  bool may_have_units_below = true;
  /// Rows may have fewer cells; the missing ones are empty.
  bool rows_may_be_short = false;
};

/// Reads a text table of any origin row by row. Accepts UTF-8, UTF-16 or Latin-1, plain or compressed with
/// gzip; LF, CRLF or CR; commas, semicolons, tabs or blanks; quotes and decimal commas; comments (`#`, `%`,
/// `//`); lines before the header; units of the columns in a line below it.
///
///     TableReader table(openFile(path), path.string(), {isHeader}, &diagnostics);
///     while (table.next()) use(table.number(time_column));
///
/// The header, or without one the first row, defines the number of columns. Rows with another number are
/// reported and skipped. Memory use does not depend on the length of the file.
class TableReader {
 public:
  /// `name` is for messages. Throws InputError where the bytes are not text. `diagnostics` must outlive the
  /// reader.
  TableReader(std::unique_ptr<ByteSource> bytes, std::string name, TableOptions options,
              Diagnostics* diagnostics);
  TableReader(const std::filesystem::path& file, const TableOptions& options, Diagnostics* diagnostics)
      : TableReader(openFile(file), file.string(), options, diagnostics) {}

  bool hasHeader() const { return !columns_.empty(); }
  const std::vector<ColumnName>& columns() const { return columns_; }  ///< of the header
  /// Number of cells of every row; 0 where there is no row.
  std::size_t columnCount() const { return column_count_; }
  /// The first 1000 lines before the first row except the header, as written.
  const std::vector<std::string>& preamble() const { return preamble_; }
  /// The last line before the first row that is neither header nor comment: a header unknown to the caller,
  /// for messages. Empty where there is none.
  const std::string& unknownHeader() const { return unknown_header_; }

  Separator separator() const { return separator_; }  ///< of the rows
  /// The word before each row, as in `Raw:1,2,3`; rows with another or no label are skipped. Usually empty.
  const std::string& label() const { return label_; }

  /// Moves to the next row that has as many cells as there are columns; returns false after the last one.
  /// Throws InputError at the end where the table had rows but none of them fitted
  /// (TableOptions::needs_rows).
  bool next();

  std::string_view cell(std::size_t column) const { return cells_[column]; }
  /// The cell as a number (numberFrom), possibly NaN or infinite.
  std::optional<double> number(std::size_t column) const { return numberFrom(cells_[column]); }
  /// The cell as a time in `unit`, exact to the nanosecond.
  std::optional<int64_t> time_ns(std::size_t column, TimeUnit unit) const {
    const std::string_view cell = cells_[column];
    // A cell of digits and points needs no conversion to another string.
    const bool is_plain = cell.find_first_not_of("0123456789.+-eE") == std::string_view::npos;
    return is_plain ? parseTime_ns(cell, unit) : parseTime_ns(withDecimalPoint(cell), unit);
  }

  int line() const { return line_number_; }
  std::size_t bytesRead() const { return lines_.bytesRead(); }
  std::string where() const;                     ///< "file:line"
  bool isCutOff() const { return is_cut_off_; }  ///< the file ends within this row

  /// Reports that this row cannot be used, with the reason.
  void passOver(const std::string& problem);

 private:
  struct Line {
    std::string text;
    int number = 0;
    bool was_too_long = false;
    bool is_cut_off = false;
  };

  bool takeLine(Line* line);
  void readPreamble();
  bool readAsHeader(const Line& line, std::string_view text);
  bool splitNames(std::string_view text, Separator separator, std::vector<ColumnName>* names);
  void readUnitsBelow();
  void settleSeparator();
  void takeHeaderAsProse();
  void nameFurtherColumns(std::size_t count);
  void split(std::string_view text, Separator separator, std::vector<std::string_view>* cells);
  /// Whether the number of cells_ equals the number of columns, after removal of empty cells at the end.
  bool fits();
  void reportMisfit();
  /// Throws InputError where the row is a header with other columns, because later rows would be misread.
  void refuseOtherHeader();

  TextLines lines_;
  std::string name_;
  TableOptions options_;
  Diagnostics* diagnostics_;
  std::deque<Line> pending_;  ///< lines read in advance, not yet returned
  std::vector<ColumnName> columns_;
  std::string header_text_;
  int header_line_ = 0;
  bool header_is_comment_ = false;
  std::vector<std::string> preamble_;
  std::string unknown_header_;
  std::string label_;
  std::size_t column_count_ = 0;
  Separator separator_ = Separator::Comma;
  Line line_;
  int line_number_ = 0;
  bool is_cut_off_ = false;
  std::vector<std::string_view> cells_;
  std::vector<std::string> unquoted_;
  std::size_t fitting_rows_ = 0;
  std::string first_misfit_;
};

}  // namespace lodeline
