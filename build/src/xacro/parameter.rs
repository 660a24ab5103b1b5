//! Parameters of a macro, as its definition lists them.

/// One of them.
#[derive(Debug)]
pub struct Parameter {
    pub name: String,
    /// `^`: taken from the caller's scope where it has one.
    pub forward: bool,
    pub default: Option<String>,
}

/// `a b:=1 c:=^ d:=^|${x} *block **blocks`
pub fn parameters(text: &str) -> Vec<Parameter> {
    let mut list = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let end = rest.find(|c: char| c.is_whitespace() || c == ':' || c == '=');
        let (name, mut after) = rest.split_at(end.unwrap_or(rest.len()));
        let sign = after.trim_start();
        let value = sign.strip_prefix(":=").or_else(|| sign.strip_prefix('='));
        let mut parameter = Parameter {
            name: name.to_owned(),
            forward: false,
            default: None,
        };
        if let Some(value) = value {
            let value = value.trim_start();
            let (forward, value) = match value.strip_prefix('^') {
                Some(rest) => (true, rest.strip_prefix('|').unwrap_or(rest)),
                None => (false, value),
            };
            let end = default_end(value);
            parameter.forward = forward;
            // Nothing after the sign is no default.
            parameter.default = (end > 0).then(|| value[..end].to_owned());
            after = &value[end..];
        } else if name.is_empty() {
            break;
        }
        list.push(parameter);
        rest = after.trim_start();
    }
    list
}

/// Where a default ends: at white space outside of quotes, or with its expression.
fn default_end(text: &str) -> usize {
    for (open, close) in [("${", '}'), ("$(", ')')] {
        if text.starts_with(open)
            && let Some(end) = text.find(close)
            && text[end + 1..]
                .chars()
                .next()
                .is_none_or(char::is_whitespace)
        {
            return end + 1;
        }
    }
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c.is_whitespace() => return at,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forms that the tests of xacro itself have.
    #[test]
    fn parameters_have_defaults_are_forwarded_and_may_be_blocks() {
        let list = parameters("a b:=1 c:=^ d:=^|${x + 1} e='two words' *f **g h:= i:=$(find p)/x");
        let shown: Vec<String> = list
            .iter()
            .map(|p| format!("{} {} {:?}", p.name, p.forward, p.default.as_deref()))
            .collect();
        assert_eq!(
            shown,
            [
                "a false None",
                "b false Some(\"1\")",
                "c true None",
                "d true Some(\"${x + 1}\")",
                "e false Some(\"'two words'\")",
                "*f false None",
                "**g false None",
                "h false Some(\"i:=$(find\")",
                "p)/x false None",
            ]
        );
    }
}
