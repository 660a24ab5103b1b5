//! Expressions of Python, as far as robots use them → their parts.
//!
//! Over 500 lines because it is one grammar.

use std::rc::Rc;

/// An expression.
#[derive(Clone, Debug)]
pub enum Expression {
    Number(f64),
    Whole(i64),
    Text(Rc<str>),
    Name(String),
    List(Vec<Expression>),
    Tuple(Vec<Expression>),
    Dict(Vec<(Expression, Expression)>),
    Each(Box<Each>),
    Unary(&'static str, Box<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
    /// The first, and each that it is compared with.
    Compare(Box<Expression>, Vec<(&'static str, Expression)>),
    And(Box<Expression>, Box<Expression>),
    Or(Box<Expression>, Box<Expression>),
    /// Condition, then, else.
    Choice(Box<[Expression; 3]>),
    Attribute(Box<Expression>, String),
    Item(Box<Expression>, Box<Expression>),
    Slice(Box<Expression>, [Option<Box<Expression>>; 3]),
    Call(Box<Expression>, Vec<Expression>, Vec<(String, Expression)>),
}

/// `value for names in list if condition`
#[derive(Clone, Debug)]
pub struct Each {
    pub value: Expression,
    pub names: Vec<String>,
    pub list: Expression,
    pub conditions: Vec<Expression>,
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Whole(i64),
    Text(String),
    Name(String),
    Sign(&'static str),
}

/// Longer ones first.
const SIGNS: [&str; 35] = [
    "**", "//", "<<", ">>", "==", "!=", "<=", ">=", "+", "-", "*", "/", "%", "<", ">", "(", ")",
    "[", "]", "{", "}", ",", ":", ".", "=", "&", "|", "^", "~", ";", "@", "!", "?", "$", "\\",
];

/// Levels of brackets that are read.
const DEEPEST: usize = 60;

/// The parts of an expression, or what is wrong with it.
pub fn expression(text: &str) -> Result<Expression, String> {
    let mut parser = Parser {
        tokens: tokens(text)?,
        at: 0,
        depth: 0,
    };
    let found = parser.tuple()?;
    match parser.peek() {
        None => Ok(found),
        Some(token) => Err(format!("{} is not expected", shown(token))),
    }
}

fn shown(token: &Token) -> String {
    match token {
        Token::Number(value) => value.to_string(),
        Token::Whole(value) => value.to_string(),
        Token::Text(text) => format!("'{text}'"),
        Token::Name(name) => format!("'{name}'"),
        Token::Sign(sign) => format!("'{sign}'"),
    }
}

fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let mut list = Vec::new();
    let mut rest = text.trim_start();
    while let Some(c) = rest.chars().next() {
        let next = rest[c.len_utf8()..].chars().next();
        let used = if c.is_ascii_digit() || c == '.' && next.is_some_and(|n| n.is_ascii_digit()) {
            let (token, used) = number(rest)?;
            list.push(token);
            used
        } else if c.is_alphabetic() || c == '_' {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            let end = end.unwrap_or(rest.len());
            if rest[end..].starts_with(['\'', '"']) && end <= 2 {
                return Err(format!(
                    "texts with '{}' before them are not known",
                    &rest[..end]
                ));
            }
            list.push(Token::Name(rest[..end].to_owned()));
            end
        } else if c == '\'' || c == '"' {
            let (text, used) = string(rest, c)?;
            // Texts side by side are one.
            if let Some(Token::Text(before)) = list.last_mut() {
                before.push_str(&text);
            } else {
                list.push(Token::Text(text));
            }
            used
        } else {
            let sign = SIGNS.iter().find(|sign| rest.starts_with(**sign));
            let sign = sign.ok_or_else(|| format!("'{c}' is not expected"))?;
            list.push(Token::Sign(sign));
            sign.len()
        };
        rest = rest[used..].trim_start();
    }
    Ok(list)
}

fn number(text: &str) -> Result<(Token, usize), String> {
    let bytes = text.as_bytes();
    let radix = match bytes.get(..2) {
        Some(b"0x" | b"0X") => Some(16),
        Some(b"0b" | b"0B") => Some(2),
        Some(b"0o" | b"0O") => Some(8),
        _ => None,
    };
    if let Some(radix) = radix {
        let end = text[2..]
            .find(|c: char| !c.is_alphanumeric())
            .map_or(text.len(), |end| end + 2);
        let value = i64::from_str_radix(&text[2..end], radix);
        let value = value.map_err(|_| format!("'{}' is no number", &text[..end]))?;
        return Ok((Token::Whole(value), end));
    }
    let digits = |from: usize| {
        let rest = bytes[from..].iter();
        from + rest
            .take_while(|b| b.is_ascii_digit() || **b == b'_')
            .count()
    };
    let mut end = digits(0);
    let mut whole = true;
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
        whole = false;
    }
    if let Some(b'e' | b'E') = bytes.get(end) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let after = digits(end + 1 + sign);
        if after > end + 1 + sign {
            end = after;
            whole = false;
        }
    }
    let digits = text[..end].replace('_', "");
    if let Some(c) = text[end..].chars().next()
        && (c.is_alphabetic() || c == '_')
    {
        return Err(format!("'{}{c}' is no number", &text[..end]));
    }
    let bad = || format!("'{digits}' is no number");
    if whole && let Ok(value) = digits.parse() {
        return Ok((Token::Whole(value), end));
    }
    Ok((Token::Number(digits.parse().map_err(|_| bad())?), end))
}

fn string(text: &str, quote: char) -> Result<(String, usize), String> {
    let mut out = String::new();
    let mut characters = text.char_indices().skip(1);
    while let Some((at, c)) = characters.next() {
        match c {
            c if c == quote => return Ok((out, at + 1)),
            '\\' => match characters.next() {
                Some((_, 'n')) => out.push('\n'),
                Some((_, 't')) => out.push('\t'),
                Some((_, c @ ('\\' | '\'' | '"'))) => out.push(c),
                Some((_, c)) => {
                    out.push('\\');
                    out.push(c);
                }
                None => break,
            },
            c => out.push(c),
        }
    }
    Err(format!("a {quote} is missing at the end of a text"))
}

struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
}

/// Words that are no names.
const WORDS: [&str; 11] = [
    "and", "or", "not", "in", "is", "if", "else", "for", "lambda", "await", "yield",
];

impl Parser {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    fn sign(&mut self, among: &[&'static str]) -> Option<&'static str> {
        let Some(Token::Sign(sign)) = self.peek() else {
            return None;
        };
        let found = among.iter().find(|known| *known == sign).copied()?;
        self.at += 1;
        Some(found)
    }

    fn word(&mut self, word: &str) -> bool {
        let is = matches!(self.peek(), Some(Token::Name(name)) if name == word);
        self.at += usize::from(is);
        is
    }

    fn need(&mut self, sign: &'static str) -> Result<(), String> {
        if self.sign(&[sign]).is_some() {
            return Ok(());
        }
        Err(self.peek().map_or_else(
            || format!("'{sign}' is missing at the end"),
            |token| format!("'{sign}' is missing before {}", shown(token)),
        ))
    }

    /// An expression, or several with commas between them.
    fn tuple(&mut self) -> Result<Expression, String> {
        let first = self.choice()?;
        if self.sign(&[","]).is_none() {
            return Ok(first);
        }
        let mut all = vec![first];
        while self.starts() {
            all.push(self.choice()?);
            if self.sign(&[","]).is_none() {
                break;
            }
        }
        Ok(Expression::Tuple(all))
    }

    /// Whether another expression comes.
    fn starts(&self) -> bool {
        match self.peek() {
            None => false,
            Some(Token::Sign(sign)) => ["(", "[", "{", "-", "+", "~"].contains(sign),
            Some(Token::Name(name)) => name == "not" || !WORDS.contains(&name.as_str()),
            Some(_) => true,
        }
    }

    fn choice(&mut self) -> Result<Expression, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("the expression is nested too deeply".to_owned());
        }
        let then = self.or()?;
        let found = if self.word("if") {
            let condition = self.or()?;
            if !self.word("else") {
                return Err("'else' is missing".to_owned());
            }
            let other = self.choice()?;
            Expression::Choice(Box::new([condition, then, other]))
        } else {
            then
        };
        self.depth -= 1;
        Ok(found)
    }

    fn or(&mut self) -> Result<Expression, String> {
        let mut left = self.and()?;
        while self.word("or") {
            left = Expression::Or(Box::new(left), Box::new(self.and()?));
        }
        Ok(left)
    }

    fn and(&mut self) -> Result<Expression, String> {
        let mut left = self.not()?;
        while self.word("and") {
            left = Expression::And(Box::new(left), Box::new(self.not()?));
        }
        Ok(left)
    }

    fn not(&mut self) -> Result<Expression, String> {
        let mut count = 0;
        while self.word("not") {
            count += 1;
        }
        let mut found = self.comparison()?;
        for _ in 0..count {
            found = Expression::Unary("not", Box::new(found));
        }
        Ok(found)
    }

    fn comparison(&mut self) -> Result<Expression, String> {
        let first = self.binary(0)?;
        let mut others = Vec::new();
        loop {
            let sign = if let Some(sign) = self.sign(&["==", "!=", "<=", ">=", "<", ">"]) {
                sign
            } else if self.word("in") {
                "in"
            } else if self.word("is") {
                if self.word("not") { "is not" } else { "is" }
            } else if matches!(self.peek(), Some(Token::Name(name)) if name == "not")
                && matches!(self.tokens.get(self.at + 1), Some(Token::Name(name)) if name == "in")
            {
                self.at += 2;
                "not in"
            } else {
                break;
            };
            others.push((sign, self.binary(0)?));
        }
        Ok(if others.is_empty() {
            first
        } else {
            Expression::Compare(Box::new(first), others)
        })
    }

    /// Operators between two values, by how tightly they bind.
    fn binary(&mut self, level: usize) -> Result<Expression, String> {
        const LEVELS: [&[&str]; 6] = [
            &["|"],
            &["^"],
            &["&"],
            &["<<", ">>"],
            &["+", "-"],
            &["*", "//", "/", "%"],
        ];
        let Some(signs) = LEVELS.get(level) else {
            return self.unary();
        };
        let mut left = self.binary(level + 1)?;
        while let Some(sign) = self.sign(signs) {
            let right = self.binary(level + 1)?;
            left = Expression::Binary(sign, Box::new(left), Box::new(right));
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Expression, String> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err("the expression is nested too deeply".to_owned());
        }
        let found = if let Some(sign) = self.sign(&["-", "+", "~"]) {
            Expression::Unary(sign, Box::new(self.unary()?))
        } else {
            let base = self.postfix()?;
            if self.sign(&["**"]).is_some() {
                Expression::Binary("**", Box::new(base), Box::new(self.unary()?))
            } else {
                base
            }
        };
        self.depth -= 1;
        Ok(found)
    }

    fn postfix(&mut self) -> Result<Expression, String> {
        let mut found = self.atom()?;
        loop {
            match self.sign(&[".", "[", "("]) {
                Some(".") => {
                    let Some(Token::Name(name)) = self.peek().cloned() else {
                        return Err("a name is missing after '.'".to_owned());
                    };
                    self.at += 1;
                    found = Expression::Attribute(Box::new(found), name);
                }
                Some("[") => found = self.subscript(found)?,
                Some(_) => found = self.call(found)?,
                None => return Ok(found),
            }
        }
    }

    fn subscript(&mut self, of: Expression) -> Result<Expression, String> {
        let mut parts: [Option<Box<Expression>>; 3] = [None, None, None];
        let mut part = 0;
        let mut slice = false;
        loop {
            if self.sign(&[":"]).is_some() {
                slice = true;
                part += 1;
                if part > 2 {
                    return Err("too many ':' in []".to_owned());
                }
            } else if self.sign(&["]"]).is_some() {
                break;
            } else if parts[part].is_none() {
                parts[part] = Some(Box::new(self.tuple()?));
            } else {
                return Err("']' is missing".to_owned());
            }
        }
        if slice {
            return Ok(Expression::Slice(Box::new(of), parts));
        }
        let [Some(index), ..] = parts else {
            return Err("[] is empty".to_owned());
        };
        Ok(Expression::Item(Box::new(of), index))
    }

    fn call(&mut self, function: Expression) -> Result<Expression, String> {
        let (mut values, mut named) = (Vec::new(), Vec::new());
        while self.sign(&[")"]).is_none() {
            let name = match (self.peek(), self.tokens.get(self.at + 1)) {
                (Some(Token::Name(name)), Some(Token::Sign("="))) => Some(name.clone()),
                _ => None,
            };
            if let Some(name) = name {
                self.at += 2;
                named.push((name, self.choice()?));
            } else {
                let value = self.choice()?;
                values.push(self.each(value)?);
            }
            if self.sign(&[","]).is_none() {
                self.need(")")?;
                break;
            }
        }
        Ok(Expression::Call(Box::new(function), values, named))
    }

    /// What follows a value in brackets: `for x in list if …`
    fn each(&mut self, value: Expression) -> Result<Expression, String> {
        if !self.word("for") {
            return Ok(value);
        }
        let mut names = Vec::new();
        while let Some(Token::Name(name)) = self.peek().cloned() {
            if WORDS.contains(&name.as_str()) {
                break;
            }
            names.push(name);
            self.at += 1;
            _ = self.sign(&[","]);
        }
        if names.is_empty() || !self.word("in") {
            return Err("'for' needs names and 'in'".to_owned());
        }
        let list = self.or()?;
        let mut conditions = Vec::new();
        while self.word("if") {
            conditions.push(self.or()?);
        }
        Ok(Expression::Each(Box::new(Each {
            value,
            names,
            list,
            conditions,
        })))
    }

    fn atom(&mut self) -> Result<Expression, String> {
        let token = self
            .peek()
            .cloned()
            .ok_or("the expression ends too early")?;
        self.at += 1;
        Ok(match token {
            Token::Number(value) => Expression::Number(value),
            Token::Whole(value) => Expression::Whole(value),
            Token::Text(text) => Expression::Text(text.into()),
            Token::Name(name) if WORDS.contains(&name.as_str()) => {
                return Err(format!("'{name}' is not expected"));
            }
            Token::Name(name) => Expression::Name(name),
            Token::Sign("(") => {
                if self.sign(&[")"]).is_some() {
                    return Ok(Expression::Tuple(Vec::new()));
                }
                let inner = self.tuple()?;
                let inner = self.each(inner)?;
                self.need(")")?;
                inner
            }
            Token::Sign("[") => {
                let mut list = Vec::new();
                while self.sign(&["]"]).is_none() {
                    let value = self.choice()?;
                    match self.each(value)? {
                        each @ Expression::Each(_) if list.is_empty() => {
                            self.need("]")?;
                            return Ok(each);
                        }
                        value => list.push(value),
                    }
                    if self.sign(&[","]).is_none() {
                        self.need("]")?;
                        break;
                    }
                }
                Expression::List(list)
            }
            Token::Sign("{") => {
                let mut pairs = Vec::new();
                while self.sign(&["}"]).is_none() {
                    let key = self.choice()?;
                    self.need(":")?;
                    pairs.push((key, self.choice()?));
                    if self.sign(&[","]).is_none() {
                        self.need("}")?;
                        break;
                    }
                }
                Expression::Dict(pairs)
            }
            token @ Token::Sign(_) => return Err(format!("{} is not expected", shown(&token))),
        })
    }
}
