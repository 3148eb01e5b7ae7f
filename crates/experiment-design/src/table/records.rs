//! The records of a CSV text: fields, quotes, and the first line of each.

/// Most fields of a record: the columns of a sheet of a workbook.
pub(super) const MOST_FIELDS: usize = 16_384;

/// A text that is read record by record.
pub(super) struct Records<'a> {
    /// The remaining text.
    rest: &'a str,
    /// The character that ends a line; a carriage return before a line feed belongs to it.
    end: char,
    /// The line in which the rest begins, from 1.
    line: usize,
}

impl<'a> Records<'a> {
    /// The records of a text whose lines end by a line feed, with or without a carriage return before it, or all by a carriage
    /// return alone.
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            end: if text.contains('\n') { '\n' } else { '\r' },
            line: 1,
        }
    }

    /// The next line without its end, and its number; `None` at the end of the text.
    pub(super) fn line(&self) -> Option<(usize, &'a str)> {
        let line = self.rest.split(self.end).next()?;
        let line = line.strip_suffix('\r').unwrap_or(line);
        (!self.rest.is_empty()).then_some((self.line, line))
    }

    /// Skips the next line.
    pub(super) fn skip_line(&mut self) {
        self.rest = self.rest.split_once(self.end).map_or("", |(_, rest)| rest);
        self.line += 1;
    }

    /// Takes the next record: fields between separators, in quotes where one begins with a quote. A doubled quote inside quotes is
    /// a quote, and separators and ends of lines are text there; a quote within a field without quotes is one, too (5", for
    /// five inches). None if a quote stays open to the end of the text. A record with more fields than [`MOST_FIELDS`] ends
    /// behind them.
    pub(super) fn take(&mut self, separator: char) -> Option<Vec<String>> {
        let mut fields = vec![String::new()];
        let (mut quoted, mut was_quoted) = (false, false);
        let mut characters = self.rest.char_indices().peekable();
        while let Some((at, c)) = characters.next() {
            let field = fields.last_mut()?;
            if quoted {
                let doubled = c == '"' && characters.peek().is_some_and(|(_, next)| *next == '"');
                if doubled {
                    characters.next();
                } else if c == '"' {
                    quoted = false;
                    continue;
                }
                self.line += usize::from(c == self.end);
                field.push(c);
            } else if c == '"' && !was_quoted && field.trim().is_empty() {
                (quoted, was_quoted) = (true, true);
            } else if c == separator {
                if fields.len() > MOST_FIELDS {
                    // Enough to refuse it; a line of separators alone would fill the memory.
                    return Some(fields);
                }
                fields.push(String::new());
                was_quoted = false;
            } else if c == self.end {
                self.rest = &self.rest[at + c.len_utf8()..];
                self.line += 1;
                return Some(without_return(fields));
            } else {
                field.push(c);
            }
        }
        self.rest = "";
        (!quoted).then(|| without_return(fields))
    }
}

/// The fields of a record without the carriage return before its line feed.
fn without_return(mut fields: Vec<String>) -> Vec<String> {
    if let Some(last) = fields.last_mut()
        && last.ends_with('\r')
    {
        last.pop();
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::Records;

    /// All records with the lines in which they begin.
    fn all(text: &str) -> Vec<(usize, Vec<String>)> {
        let mut records = Records::new(text);
        let mut found = Vec::new();
        while let Some((line, _)) = records.line() {
            found.push((line, records.take(',').unwrap()));
        }
        found
    }

    /// RFC 4180: a remark of two lines, a doubled quote, a separator in quotes; and an inch mark, which is not a quote. Ends of lines
    /// of all three kinds.
    #[test]
    fn quotes_hold_separators_and_ends_of_lines() {
        let text = "a,b\n1,\"wet,\nnew \"\"belt\"\"\"\n2,5\" tube\n3, \"x\" \n";
        for end in ["\n", "\r\n", "\r"] {
            let found = all(&text.replace('\n', end));
            let remark = format!("wet,{end}new \"belt\"");
            let expected = [
                (1, ["a", "b"]),
                (2, ["1", &remark]),
                (4, ["2", "5\" tube"]),
                (5, ["3", " x "]),
            ];
            assert_eq!(found.len(), 4);
            for ((line, fields), (at, wanted)) in found.iter().zip(expected) {
                assert_eq!((*line, &fields[..]), (at, &wanted.map(String::from)[..]));
            }
        }
        assert_eq!(all("a,b\n1,").last().unwrap().1, ["1", ""]);
    }

    #[test]
    fn a_quote_that_stays_open_is_no_record() {
        let mut records = Records::new("a,b\n1,\"2\n3,4\n");
        records.skip_line();
        assert_eq!(records.take(','), None);
    }
}
