//! The paths that a Rust source names, found by reading it: enough of the grammar to see through
//! comments, strings, groups and renames.

/// A path such as `super::codec::Unit`, segment by segment.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Path {
    /// It begins with `::`, so that its first segment is a library.
    pub(crate) is_global: bool,
    /// The segments; `*` for everything in the one before.
    pub(crate) segments: Vec<String>,
    /// The line it ends on, from 1.
    pub(crate) line: usize,
}

/// What the grammar here is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Token {
    Word(String),
    PathSeparator,
    Other(char),
}

/// What stands between two tokens.
const BLANK: Token = Token::Other(' ');

/// Words that a path can come after, but not begin with.
const KEYWORDS: [&str; 14] = [
    "as", "const", "dyn", "else", "for", "if", "impl", "in", "let", "match", "mut", "return",
    "where", "while",
];

/// Every path of two segments or more, and every path that is brought in by `use` or
/// `extern crate`.
pub(crate) fn paths(text: &str) -> Vec<Path> {
    let mut reader = Reader {
        tokens: tokens(text),
        at: 0,
        found: Vec::new(),
    };
    while reader.at < reader.tokens.len() {
        reader.item();
    }
    reader.found
}

/// The modules that a source declares: `mod name;` and `mod name {`.
pub(crate) fn modules(text: &str) -> Vec<String> {
    let tokens: Vec<Token> = tokens(text).into_iter().map(|(token, _)| token).collect();
    tokens
        .windows(2)
        .filter_map(|pair| match pair {
            [Token::Word(keyword), Token::Word(name)] if keyword == "mod" => Some(name.clone()),
            _ => None,
        })
        .collect()
}

struct Reader {
    tokens: Vec<(Token, usize)>,
    at: usize,
    found: Vec<Path>,
}

impl Reader {
    fn peek(&self, ahead: usize) -> Option<&Token> {
        self.tokens.get(self.at + ahead).map(|(token, _)| token)
    }

    fn is_word(&self, ahead: usize, word: &str) -> bool {
        matches!(self.peek(ahead), Some(Token::Word(found)) if found == word)
    }

    fn line(&self) -> usize {
        let last = self.at.min(self.tokens.len()).saturating_sub(1);
        self.tokens.get(last).map_or(0, |(_, line)| *line)
    }

    /// Steps over one token, or over a whole path or `use`.
    fn item(&mut self) {
        // `use<'a>` says what a type captures and imports nothing.
        if self.is_word(0, "use") && self.peek(1) != Some(&Token::Other('<')) {
            self.at += 1;
            self.tree(&Path {
                is_global: false,
                segments: Vec::new(),
                line: 0,
            });
        } else if self.is_word(0, "extern") && self.is_word(1, "crate") {
            self.at += 2;
            self.path(true);
        } else if KEYWORDS.iter().any(|keyword| self.is_word(0, keyword)) {
            self.at += 1;
        } else if matches!(self.peek(0), Some(Token::Word(_) | Token::PathSeparator)) {
            self.path(false);
        } else {
            // What follows a dot is a field or a method, not the beginning of a path.
            let is_dot = self.peek(0) == Some(&Token::Other('.'));
            let is_member = is_dot && matches!(self.peek(1), Some(Token::Word(_)));
            self.at += if is_member { 2 } else { 1 };
        }
    }

    /// A path outside of `use`; one of a single segment is told only when `is_import`.
    fn path(&mut self, is_import: bool) {
        let is_global = self.peek(0) == Some(&Token::PathSeparator);
        // `<T as Trait>::Item` goes on from a type.
        let follows_type =
            self.at > 0 && self.tokens[self.at - 1].0 == Token::Other('>') && is_global;
        self.at += usize::from(is_global);
        let mut segments = Vec::new();
        while let Some(Token::Word(word)) = self.peek(0) {
            segments.push(word.clone());
            self.at += 1;
            if self.peek(0) == Some(&Token::PathSeparator)
                && matches!(self.peek(1), Some(Token::Word(_)))
            {
                self.at += 1;
            } else {
                break;
            }
        }
        let is_told = is_import || is_global || segments.len() > 1;
        if is_told && !segments.is_empty() && !follows_type {
            let line = self.line();
            self.found.push(Path {
                is_global,
                segments,
                line,
            });
        }
    }

    /// What one branch of a `use` brings in, `before` in front of it.
    fn tree(&mut self, before: &Path) {
        let mut path = before.clone();
        let start = self.at;
        loop {
            match self.peek(0).cloned() {
                Some(Token::PathSeparator) => {
                    path.is_global |= path.segments.is_empty();
                    self.at += 1;
                }
                Some(Token::Word(word)) if word == "as" => self.at += 2,
                Some(Token::Word(word)) => {
                    path.segments.push(word);
                    self.at += 1;
                }
                Some(Token::Other('*')) => {
                    path.segments.push("*".to_owned());
                    self.at += 1;
                }
                Some(Token::Other('{')) => {
                    self.at += 1;
                    while !matches!(self.peek(0), None | Some(Token::Other('}'))) {
                        self.tree(&path);
                        if self.peek(0) == Some(&Token::Other(',')) {
                            self.at += 1;
                        }
                    }
                    self.at += 1;
                    return;
                }
                _ => break,
            }
        }
        // `{self}` is the module in front of it.
        if path.segments.len() > 1 && path.segments.last().is_some_and(|last| last == "self") {
            path.segments.pop();
        }
        path.line = self.line();
        // Anything else cannot stand in a `use`: step over it, so that reading ends.
        if self.at == start {
            self.at += 1;
        } else {
            self.found.push(path);
        }
    }
}

/// The words and signs of a source with their lines, without comments and what strings hold.
fn tokens(text: &str) -> Vec<(Token, usize)> {
    let mut scanner = Scanner {
        rest: text.chars().collect(),
        at: 0,
    };
    let mut found = Vec::new();
    let (mut line, mut counted) = (1, 0);
    while let Some(token) = scanner.next_token() {
        let passed = &scanner.rest[counted..scanner.at];
        line += passed.iter().filter(|char| **char == '\n').count();
        counted = scanner.at;
        if token != BLANK {
            found.push((token, line));
        }
    }
    found
}

struct Scanner {
    rest: Vec<char>,
    at: usize,
}

impl Scanner {
    fn char(&self, ahead: usize) -> Option<char> {
        self.rest.get(self.at + ahead).copied()
    }

    fn starts_with(&self, text: &str) -> bool {
        text.chars()
            .enumerate()
            .all(|(index, char)| self.char(index) == Some(char))
    }

    /// `None` at the end; [`BLANK`] for a space or a comment.
    fn next_token(&mut self) -> Option<Token> {
        let first = self.char(0)?;
        Some(if self.starts_with("//") {
            self.skip_while(|char| char != '\n');
            BLANK
        } else if self.starts_with("/*") {
            self.skip_block_comment();
            BLANK
        } else if self.starts_with("::") {
            self.at += 2;
            Token::PathSeparator
        } else if first == '"' {
            self.skip_string();
            Token::Other('"')
        } else if first == '\'' {
            self.skip_character_or_quote();
            Token::Other('\'')
        } else if is_word_character(first) {
            self.word()
        } else {
            self.at += 1;
            if first.is_whitespace() {
                BLANK
            } else {
                Token::Other(first)
            }
        })
    }

    fn skip_while(&mut self, skip: impl Fn(char) -> bool) {
        while self.char(0).is_some_and(&skip) {
            self.at += 1;
        }
    }

    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        while self.char(0).is_some() {
            if self.starts_with("/*") {
                depth += 1;
                self.at += 2;
            } else if self.starts_with("*/") {
                depth -= 1;
                self.at += 2;
                if depth == 0 {
                    return;
                }
            } else {
                self.at += 1;
            }
        }
    }

    fn skip_string(&mut self) {
        self.at += 1;
        while let Some(char) = self.char(0) {
            self.at += if char == '\\' { 2 } else { 1 };
            if char == '"' {
                return;
            }
        }
    }

    /// From `#` or `"` behind the `r`.
    fn skip_raw_string(&mut self) {
        let start = self.at;
        self.skip_while(|char| char == '#');
        let end = format!("\"{}", "#".repeat(self.at - start));
        self.at += 1;
        while self.char(0).is_some() && !self.starts_with(&end) {
            self.at += 1;
        }
        self.at += end.len();
    }

    /// `'x'` and `'\n'` whole, of a lifetime or a label the quote alone.
    fn skip_character_or_quote(&mut self) {
        if self.char(1) == Some('\\') {
            self.at += 3;
            self.skip_while(|char| char != '\'');
            self.at += 1;
        } else if self.char(2) == Some('\'') {
            self.at += 3;
        } else {
            self.at += 1;
        }
    }

    fn word(&mut self) -> Token {
        let start = self.at;
        self.skip_while(is_word_character);
        let word: String = self.rest[start..self.at].iter().collect();
        let is_raw = matches!(word.as_str(), "r" | "br" | "cr");
        match self.char(0) {
            // `r#match` is a word, `r#"..."#` a string.
            Some('#') if is_raw && self.char(1).is_some_and(is_word_character) => {
                self.at += 1;
                BLANK
            }
            Some('"' | '#') if is_raw => {
                self.skip_raw_string();
                Token::Other('"')
            }
            _ => Token::Word(word),
        }
    }
}

fn is_word_character(char: char) -> bool {
    char.is_alphanumeric() || char == '_'
}
